// 300 scattered words of a device behind a network with a round trip of 2 ms. Compares the channel
// refreshes a second of the bridge, with several requests in flight, with a bare blocking loop, and
// with the prediction. The device of modbus-tcp is libmodbus, and the loop reads the optimal
// partition. The other devices are simulated, and the loop reads the blocks of the plan.
//
// usage: in_flight_bench [--seconds N] [--in-flight N] [--protocol NAME] [--connections N]
// NAME: modbus-tcp, s7-tcp, mitsubishi-mc, omron-fins
// --connections N: the words are those of N buses, each with a connection of its own. libmodbus
// serves one connection, so the device is then simulated with modbus-tcp too.
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "config/loader/loader.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/partition.hpp"
#include "core/protocol/families/registry.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/prediction.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

using namespace std::chrono_literals;

constexpr int kRegisters = 300;
constexpr auto kRoundTrip = 2ms;

void send_immediately(int connection) {
  const int on = 1;
  setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

int connect_to(std::uint16_t port) {
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  const sockaddr_in address = loopback(port);
  if (connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot connect to port " + std::to_string(port));
  send_immediately(connection);
  return connection;
}

// A network: passes requests on immediately, and each part of a response after the round trip.
class Network {
 public:
  explicit Network(std::uint16_t server) : server_(server), port_(free_port()) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    const sockaddr_in address = loopback(port_);
    if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_, 4) != 0)
      throw std::runtime_error("cannot listen");
    thread_ = std::thread([this] { serve(); });
  }
  ~Network() {
    ends_ = true;
    thread_.join();
    close(listener_);
  }
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  struct Part {
    Clock::time_point due;
    Bytes bytes;
  };
  void serve() {
    std::vector<std::thread> clients;
    while (!ends_) {
      pollfd waiting{listener_, POLLIN, 0};
      if (poll(&waiting, 1, 50) <= 0) continue;
      const int client = accept(listener_, nullptr, nullptr);
      if (client < 0) continue;
      send_immediately(client);
      clients.emplace_back([this, client] {
        const int server = connect_to(server_);
        carry(client, server);
        close(client);
        close(server);
      });
    }
    for (std::thread& client : clients) client.join();
  }
  void carry(int client, int server) const {
    prctl(PR_SET_TIMERSLACK, 1000);
    std::deque<Part> parts;
    Bytes buffer(65536);
    while (!ends_) {
      timespec rest{0, 50'000'000};
      if (!parts.empty()) {
        const auto left = std::max<std::chrono::nanoseconds>(0ns, parts.front().due - Clock::now());
        rest.tv_nsec = left.count();
      }
      pollfd both[2] = {{client, POLLIN, 0}, {server, POLLIN, 0}};
      ppoll(both, 2, &rest, nullptr);
      for (const auto& [from, to] : {std::pair{0, server}, std::pair{1, -1}}) {
        if ((both[from].revents & (POLLIN | POLLHUP | POLLERR)) == 0) continue;
        const auto n = read(both[from].fd, buffer.data(), buffer.size());
        if (n <= 0) return;
        // libmodbus sends a response only when the one before it was acknowledged (Nagle).
        const int on = 1;
        setsockopt(server, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
        const Bytes bytes(buffer.begin(), buffer.begin() + n);
        if (to < 0)
          parts.push_back({Clock::now() + kRoundTrip, bytes});
        else if (write(to, bytes.data(), bytes.size()) < 0)
          return;
      }
      while (!parts.empty() && parts.front().due <= Clock::now()) {
        if (write(client, parts.front().bytes.data(), parts.front().bytes.size()) < 0) return;
        parts.pop_front();
      }
    }
  }

  const std::uint16_t server_, port_;
  int listener_ = -1;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

struct Family {
  const char* protocol;
  const char* device;  // further lines of the device
  const char* word;    // address of the first word, without its number
  unsigned step = 1;   // number of one word
};
constexpr Family kFamilies[] = {
    {"modbus-tcp", "", "holding:"},
    {"s7-tcp", "", "DB1.DBW", 2},
    {"mitsubishi-mc", "        options: { frame: 4e }\n", "D"},
    {"omron-fins", "", "DM"},
};

const Family& family_of(const std::string& protocol) {
  for (const Family& family : kFamilies)
    if (protocol == family.protocol) return family;
  throw std::runtime_error("no protocol '" + protocol + "', see the usage in the source");
}

// Of the channels of a device, which are lines, those of one connection.
std::string channels_of(const std::string& devices, int connection, int connections) {
  std::string part;
  std::istringstream lines(devices);
  int channel = 0;
  for (std::string line; std::getline(lines, line);) {
    const bool is_channel = line.find("at:") != std::string::npos;
    if (!is_channel || channel++ * connections / kRegisters == connection) part += line + '\n';
  }
  return part;
}

std::string bus(const Family& family, std::uint16_t port, int in_flight, int connections = 1) {
  const std::string scattered = scattered_devices(1, kRegisters, 42);
  const std::regex address("holding:([0-9]+)");
  std::string devices;
  auto rest = scattered.begin();
  for (std::sregex_iterator at(rest, scattered.end(), address), end; at != end; ++at) {
    devices.append(rest, scattered.begin() + at->position());
    devices += family.word + std::to_string(std::stoul((*at)[1]) * family.step);
    rest = scattered.begin() + at->position() + at->length();
  }
  devices.append(rest, scattered.end());
  devices.insert(devices.find("        channels:"), family.device);
  std::string buses;
  for (int i = 0; i < connections; ++i)
    buses += "  - name: bus-" + std::to_string(i) +
             "\n    port: { tcp: \"127.0.0.1:" + std::to_string(port) +
             "\" }\n    protocol: " + family.protocol +
             "\n    in-flight: " + std::to_string(in_flight) +
             "\n    defaults: { refresh: 1s, mode: intensive }\n    devices:\n" +
             channels_of(devices, i, connections);
  return buses;
}

std::vector<BusSpec> loaded(const std::string& path) {
  auto config = config::load_file(path);
  if (!config)
    throw std::runtime_error("the bench's own configuration is faulty: " +
                             to_text(config.error().front()));
  return std::move(config->buses);
}

Prediction prediction_for(const BusSpec& bus, const Protocol& protocol, Duration response_time) {
  const Protocol* const pointer = &protocol;
  const auto input = schedule_input(bus, {&pointer, 1}, map_points(bus).points, response_time);
  return predict(input, {.horizon = 60s});
}

double predicted_refreshes(const BusSpec& bus, const Protocol& protocol, Duration response_time) {
  const Prediction prediction = prediction_for(bus, protocol, response_time);
  double reads = 0;
  for (const PointForecast& point : prediction.points) reads += static_cast<double>(point.reads);
  return reads / to_seconds(prediction.horizon);
}

struct BareRead {
  std::vector<Range> ranges;
  std::size_t channels = 0;
};

std::vector<BareRead> optimal_reads(const BusSpec& bus, const Protocol& protocol) {
  const DeviceSpec& device = bus.devices.front();
  std::vector<Wanted> wanted;
  for (const ChannelSpec& channel : device.channels)
    wanted.push_back({channel.range.first, channel.range.end()});
  const DeviceTiming timing{&protocol, kRoundTrip};
  const AreaIndex area = device.channels.front().range.area;
  const ReadCost cost(timing, area, line_of(bus.port), silence_for(bus), 125);
  std::vector<BareRead> reads;
  for (const Slice& slice : optimal_partition(wanted, cost))
    reads.push_back({{range_of(wanted, slice, cost)}, slice.end - slice.begin});
  return reads;
}

std::vector<BareRead> planned_reads(const BusSpec& bus, const Protocol& protocol) {
  std::vector<BareRead> reads;
  for (const BlockForecast& block : prediction_for(bus, protocol, kRoundTrip).blocks)
    reads.push_back({block.ranges, block.points});
  return reads;
}

bool has_lists(const BusSpec& bus, const Protocol& protocol) {
  const AreaIndex area = bus.devices.front().channels.front().range.area;
  return protocol.size(ReadRequest{{{area, 0, 1}, {area, 2, 1}}}).has_value();
}

// The simplest master: one request, its response, the next request.
double bare_loop(const Protocol& protocol, const std::vector<BareRead>& reads, std::uint16_t port,
                 double seconds) {
  const int connection = connect_to(port);
  std::uint64_t refreshes = 0;
  ExchangeContext context;
  Bytes session, out, received, buffer(4096);
  context.session = &session;
  const auto send = [&] {
    received.clear();
    if (write(connection, out.data(), out.size()) < 0)
      throw std::runtime_error("the bare loop cannot write");
    out.clear();
  };
  const auto start = Clock::now();
  while (seconds_since(start) < seconds) {
    for (const BareRead& one : reads) {
      const auto exchange = protocol.begin(ReadRequest{one.ranges}, context);
      ++context.sequence;
      out.clear();
      Step step = exchange->start(out);
      send();
      while (step.kind != Step::Kind::kDone) {
        const auto n = read(connection, buffer.data(), buffer.size());
        if (n <= 0) throw std::runtime_error("the bare loop lost its connection");
        received.insert(received.end(), buffer.begin(), buffer.begin() + n);
        step = exchange->on_bytes(received, out);
        if (step.kind == Step::Kind::kFailed) throw std::runtime_error("the device refuses a read");
        if (step.kind == Step::Kind::kSend) send();
      }
      refreshes += one.channels;
    }
  }
  close(connection);
  return static_cast<double>(refreshes) / seconds_since(start);
}

double bridge_refreshes(Plant& plant, double seconds) {
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(kRegisters, 20);
  let_run(2);
  plant.forget_samples();
  const auto start = Clock::now();
  let_run(seconds);
  double samples = 0;
  for (const auto& [name, channel] : plant.seen()) samples += static_cast<double>(channel.samples);
  const double rate = samples / seconds_since(start);
  plant.stop_bridge();
  return rate;
}

// libmodbus, or the simulator with a configuration of its own.
std::unique_ptr<Process> start_device(const Family& family, std::uint16_t port, bool simulated,
                                      const ScratchFolder& folder) {
  const std::string log = folder.path() + "/device.log";
  if (!simulated) {
    auto server = std::make_unique<Process>(
        "libmodbus-server", std::vector<std::string>{"tcp", std::to_string(port), "65535"}, log);
    if (!wait_for_text(log, "READY", 5))
      throw std::runtime_error("libmodbus-server does not start");
    return server;
  }
  const std::string config =
      folder.write("device.yaml", "bridge: device\nbuses:\n" + bus(family, port, 1));
  auto simulator =
      std::make_unique<Process>("fieldcast-sim", std::vector<std::string>{config}, log);
  if (!wait_for_text(log, std::to_string(port), 10))
    throw std::runtime_error("fieldcast-sim does not start");
  return simulator;
}

void run(double seconds, int in_flight, int connections, const Family& family) {
  prctl(PR_SET_TIMERSLACK, 1000);
  const ScratchFolder folder;
  const std::uint16_t device_port = free_port();
  const bool simulated = connections > 1 || &family != &kFamilies[0];
  const auto device = start_device(family, device_port, simulated, folder);
  const Network network(device_port);
  Plant plant(bus(family, network.port(), in_flight, connections));
  const ScratchFolder whole;
  const BusSpec spec = loaded(whole.write("whole.yaml", "bridge: whole\nbuses:\n" +
                                                            bus(family, network.port(), in_flight)))
                           .front();
  const auto protocol = make_protocol(spec.devices.front(), line_of(spec.port)).value();
  const auto reads =
      has_lists(spec, *protocol) ? planned_reads(spec, *protocol) : optimal_reads(spec, *protocol);
  double bare = 0, bridged = 0;
  for (int turn = 0; turn < 2; ++turn) {
    bare += bare_loop(*protocol, reads, network.port(), seconds) / 2;
    let_run(0.2);
    bridged += bridge_refreshes(plant, seconds) / 2;
    let_run(0.2);
  }
  const double round_trip = kRegisters / bare / static_cast<double>(reads.size());
  double predicted = 0;
  for (const BusSpec& part : loaded(plant.config()))
    predicted += predicted_refreshes(part, *protocol, from_seconds(round_trip));
  std::printf("%s, %d words in %zu reads, %d connections with %d in flight\n", family.protocol,
              kRegisters, reads.size(), connections, in_flight);
  print_figure("bare blocking loop, channel refreshes a second", bare, "1/s");
  print_figure("its round trip", 1000 * round_trip, "ms");
  print_figure("bridge, samples at a station", bridged, "1/s");
  print_figure("bridge / bare loop", bridged / bare, "", "goal >= 3 with 4 in flight");
  print_figure("predicted by the plan for this round trip", predicted, "1/s");
  print_figure("bridge / predicted", bridged / predicted, "", "goal 0.95 to 1.05");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("in_flight_bench", argc, argv, [](const Arguments& arguments) {
    run(arguments.number("--seconds", 10.0), static_cast<int>(arguments.number("--in-flight", 4)),
        static_cast<int>(arguments.number("--connections", 1)),
        family_of(arguments.text("--protocol", "modbus-tcp")));
  });
}

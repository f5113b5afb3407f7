// 300 scattered holding registers in 3 units on a line of 115200 baud, devices with a response time
// of 2 ms. Compares the channel refreshes a second of the bridge with a bare blocking loop over the
// optimal partition on the same emulated wire, and with the theoretical maximum.
//
// usage: wire_bench [--seconds N]
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <stdexcept>
#include <string>

#include "config/loader/loader.hpp"
#include "core/codec/checksum.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/partition.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

constexpr int kUnits = 3;
constexpr int kRegisters = 100;
constexpr auto kResponseTime = std::chrono::milliseconds(2);

std::string buses() {
  return serial_bus("bus", 115200, "refresh: 1s, mode: intensive, silence: 3.5c",
                    scattered_devices(kUnits, kRegisters, 42));
}

struct BareRead {
  Bytes request;
  std::size_t response = 0;  // bytes
  std::size_t channels = 0;  // channels refreshed by the read
};

struct BarePlan {
  std::vector<BareRead> reads;
  Duration theory{};  // wire time of one round of all reads
};

BarePlan optimal_plan(const BusSpec& bus) {
  BarePlan plan;
  const LineFormat line = line_of(bus.port);
  const Duration silence = silence_of(bus.silence, line);
  for (const DeviceSpec& device : bus.devices) {
    const auto protocol = find_protocol(device.protocol)->make(device.link);
    std::vector<Wanted> wanted;
    for (const ChannelSpec& channel : device.channels)
      wanted.push_back({channel.range.first, channel.range.end()});
    const DeviceTiming timing{protocol->get(), kResponseTime};
    const ReadCost cost(timing, device.channels.front().range.area, line, silence, 125);
    const auto slices = optimal_partition(wanted, cost);
    plan.theory += cost_of(wanted, slices, cost);
    for (const Slice& slice : slices) {
      const Range range = range_of(wanted, slice, cost);
      Bytes request{static_cast<std::uint8_t>(device.link.address), 3};
      append_u16(request, static_cast<std::uint16_t>(range.first));
      append_u16(request, static_cast<std::uint16_t>(range.count));
      append_crc16(request);
      plan.reads.push_back({std::move(request), 5 + 2 * range.count, slice.end - slice.begin});
    }
  }
  return plan;
}

void read_exactly(int line, std::size_t bytes) {
  std::uint8_t buffer[512];
  for (std::size_t got = 0; got < bytes;) {
    pollfd readable{line, POLLIN, 0};
    if (poll(&readable, 1, 1000) <= 0) throw std::runtime_error("the bare loop got no response");
    const auto n = read(line, buffer, sizeof buffer);
    if (n <= 0) throw std::runtime_error("the bare loop lost its line");
    got += static_cast<std::size_t>(n);
  }
}

// The simplest master with the optimal partition.
double bare_loop(const BarePlan& plan, const std::string& path, Duration silence, double seconds) {
  const int line = open(path.c_str(), O_RDWR | O_NOCTTY);
  if (line < 0) throw std::runtime_error("cannot open " + path);
  termios raw{};
  tcgetattr(line, &raw);
  cfmakeraw(&raw);
  tcsetattr(line, TCSANOW, &raw);
  tcflush(line, TCIOFLUSH);
  std::uint64_t refreshes = 0;
  const auto start = Clock::now();
  const auto end = start + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    for (const BareRead& one : plan.reads) {
      if (write(line, one.request.data(), one.request.size()) < 0)
        throw std::runtime_error("the bare loop cannot write");
      read_exactly(line, one.response);
      refreshes += one.channels;
      const timespec rest{0, silence.count()};
      clock_nanosleep(CLOCK_MONOTONIC, 0, &rest, nullptr);
    }
  }
  const double wall = seconds_since(start);
  close(line);
  return static_cast<double>(refreshes) / wall;
}

struct BridgeFigures {
  double refreshes = 0;  // a second
  double evenness = 0;   // longest gap of any channel / shortest of any
};

BridgeFigures bridge_figures(Plant& plant, double seconds) {
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(kUnits * kRegisters, 20);
  let_run(2);
  plant.forget_samples();
  const auto start = Clock::now();
  let_run(seconds);
  const auto seen = plant.seen();
  const double wall = seconds_since(start);
  double longest = 0, shortest = 1e18, samples = 0;
  for (const auto& [name, channel] : seen) {
    samples += static_cast<double>(channel.samples);
    longest = std::max(longest, static_cast<double>(channel.longest_gap));
    shortest = std::min(shortest, static_cast<double>(channel.shortest_gap));
  }
  return {samples / wall, longest / shortest};
}

void run(double seconds) {
  prctl(PR_SET_TIMERSLACK, 1000);
  Plant plant(buses());
  const auto loaded = config::load_file(plant.config());
  if (!loaded)
    throw std::runtime_error("the bench's own configuration is faulty: " +
                             to_text(loaded.error().front()));
  const BusSpec& bus = loaded->buses.front();
  const BarePlan plan = optimal_plan(bus);
  plant.start_simulator();
  const double theory = kUnits * kRegisters / to_seconds(plan.theory);
  // Alternating, so that other load affects both alike.
  double bare = 0, bridged = 0, evenness = 0;
  for (int turn = 0; turn < 2; ++turn) {
    bare +=
        bare_loop(plan, plant.link("bus"), silence_of(bus.silence, line_of(bus.port)), seconds) / 2;
    const BridgeFigures figures = bridge_figures(plant, seconds);
    bridged += figures.refreshes / 2;
    evenness = std::max(evenness, figures.evenness);
    plant.stop_bridge();
    let_run(0.2);
  }
  std::printf("%d registers, %zu reads in the optimal partition\n", kUnits * kRegisters,
              plan.reads.size());
  print_figure("theory, channel refreshes a second", theory, "1/s");
  print_figure("bare blocking loop", bare, "1/s");
  print_figure("bare loop / theory", bare / theory, "", "about 0.95");
  print_figure("bridge, samples at a station", bridged, "1/s");
  print_figure("bridge / bare loop", bridged / bare, "", "goal >= 0.98");
  print_figure("bridge / theory", bridged / theory);
  print_figure("longest gap of any channel / shortest", evenness, "", "goal <= 1.3");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("wire_bench", argc, argv,
                   [](const Arguments& arguments) { run(arguments.number("--seconds", 10.0)); });
}

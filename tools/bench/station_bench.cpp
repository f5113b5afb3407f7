// Measures the cost of fieldcast-station and the age of the values on its pages: a bridge without
// wires publishes every channel once a second, and WebSocket clients read everything. Bridge and
// station are separate processes on the loopback, in a separate DDS domain.
//
// usage: station_bench [--channels N] [--seconds S] [--stopped S] [--hours H]
//
// --channels: 10000, on 10 buses. --seconds: of each measurement, 8. --stopped: how long one client
// stops reading, 60; 0 skips this part. --hours: instead, runs the model and its clients for this
// many hours of virtual time, without sockets and DDS.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/live_clients.hpp"
#include "tools/bench/support/live_hours.hpp"

namespace fieldcast::bench {
namespace {

constexpr int kBuses = 10;

struct Options {
  int channels;
  double seconds, stopped;
};

void print_goal(const char* what, double value, const char* unit, double goal) {
  std::printf("%-58s %12.4g %-10s goal < %g: ratio %.2f%s\n", what, value, unit, goal, value / goal,
              value < goal ? "" : "  NOT REACHED");
  std::fflush(stdout);
}

// cpu_seconds() counts in kernel ticks and misses short bursts.
double run_seconds(pid_t process) {
  double seconds = 0;
  const std::string threads = "/proc/" + std::to_string(process) + "/task";
  for (const auto& thread : std::filesystem::directory_iterator(threads)) {
    std::ifstream file(thread.path() / "schedstat");
    double nanoseconds = 0;
    file >> nanoseconds;
    seconds += nanoseconds / 1e9;
  }
  return seconds;
}

class StationBench {
 public:
  explicit StationBench(const Options& options)
      : options_(options),
        domain_(own_domain()),
        port_(free_port()),
        bridge_("bench_bridge",
                {std::to_string(domain_), std::to_string(kBuses),
                 std::to_string(options.channels / kBuses)},
                folder_.path() + "/bridge.log"),
        station_("fieldcast-station", {"--config", configuration()}, log()) {}

  void run() {
    wait_until_complete();
    with_clients(0);
    first_data();
    with_clients(1);
    with_clients(20);
    if (options_.stopped > 0) stopped_client();
  }

 private:
  [[nodiscard]] std::string log() const { return folder_.path() + "/station.log"; }
  [[nodiscard]] std::string configuration() const {
    return folder_.write("station.yaml",
                         "station: bench\ndds: { domain: " + std::to_string(domain_) +
                             ", interfaces: [127.0.0.1] }\nweb: { listen: \"127.0.0.1:" +
                             std::to_string(port_) + "\" }\n");
  }
  [[nodiscard]] std::uint64_t all() const { return static_cast<std::uint64_t>(options_.channels); }

  void wait_until_complete() {
    if (!wait_for_text(log(), "served at", 20))
      throw std::runtime_error("the station did not start; see " + log());
    const auto begin = Clock::now();
    LiveClients clients(port_);
    const std::size_t client = clients.connect();
    if (clients.first_data(client, all(), 60) == 0)
      throw std::runtime_error("not all channels came");
    print_figure("start of the station to every value at a page", seconds_since(begin), "s");
  }

  void with_clients(std::size_t count) {
    std::printf("%zu clients, %d channels, each once a second\n", count, options_.channels);
    LiveClients clients(port_);
    for (std::size_t i = 0; i < count; ++i) (void)clients.connect();
    let_run(2);
    clients.mark();
    const double share = share_during(options_.seconds);
    print_goal("  processor of the station", share, "cores", 0.35);
    print_goal("  memory of the station", station_.resident_mb(), "MB", 60);
    if (count > 0) print_received(clients, count, options_.seconds);
  }

  double share_during(double seconds) {
    const double before = run_seconds(station_.id());
    let_run(seconds);
    return (run_seconds(station_.id()) - before) / seconds;
  }

  static void print_received(const LiveClients& clients, std::size_t count, double seconds) {
    std::vector<double> ages;
    double bytes = 0, frames = 0, values = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const LiveReceived received = clients.received(i);
      ages.insert(ages.end(), received.spread_ms.begin(), received.spread_ms.end());
      bytes += static_cast<double>(received.bytes);
      frames += static_cast<double>(received.frames);
      values += static_cast<double>(received.values);
    }
    const double each = static_cast<double>(count) * seconds;
    print_figure("  values of each client", values / each, "1/s");
    print_figure("  frames of each client", frames / each, "1/s");
    print_figure("  bytes of each client", bytes / each / 1e3, "kB/s");
    print_goal("  acquired to received, p50", quantile(ages, 0.5), "ms", 50);
    print_goal("  acquired to received, p99", quantile(ages, 0.99), "ms", 100);
  }

  void first_data() {
    LiveClients clients(port_);
    const Fetched catalogue = fetch(port_, "/api/catalogue");
    if (catalogue.status == 200) {
      print_figure("catalogue by HTTP", static_cast<double>(catalogue.bytes) / 1e3, "kB");
      print_goal("catalogue by HTTP", catalogue.seconds, "s", 0.5);
    }
    const std::size_t client = clients.connect();
    print_goal("connect to a value of every channel, late client",
               clients.first_data(client, all(), 10), "s", 1);
  }

  void stopped_client() {
    std::printf("one of 20 clients reads nothing for %.0f s\n", options_.stopped);
    LiveClients clients(port_);
    for (std::size_t i = 0; i < 20; ++i) (void)clients.connect();
    let_run(4);
    const double before = station_.resident_mb();
    const std::size_t stopped = 19;
    clients.stop_reading(stopped);
    clients.mark();
    const double share = share_during(options_.stopped);
    print_goal("  processor of the station meanwhile", share, "cores", 0.35);
    print_goal("  memory that the station took meanwhile", station_.resident_mb() - before, "MB",
               1);
    print_received(clients, stopped, options_.stopped);
    const auto begin = Clock::now();
    clients.resume(stopped);
    double current = 0;
    while (current < 10) {
      current = seconds_since(begin);
      if (!clients.is_open(stopped)) throw std::runtime_error("the station closed the client");
      if (clients.age(stopped) < 0.2) break;
      let_run(0.005);
    }
    print_goal("  until it is current again", current, "s", 1);
    print_figure("  bytes that it still had to read",
                 static_cast<double>(clients.received(stopped).bytes) / 1e6, "MB");
  }

  const Options options_;
  ScratchFolder folder_;
  const unsigned domain_;
  const std::uint16_t port_;
  Process bridge_;
  Process station_;
};

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  const Arguments arguments(argc, argv);
  const double hours = arguments.number("--hours", 0.0);
  return run_bench("station_bench", [&] {
    if (hours > 0) return run_hours(hours);
    StationBench({.channels = arguments.number("--channels", 10'000),
                  .seconds = arguments.number("--seconds", 8.0),
                  .stopped = arguments.number("--stopped", 60.0)})
        .run();
  });
}

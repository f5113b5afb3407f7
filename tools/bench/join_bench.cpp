// Measures how long a late joiner needs for the catalogue and the last value of every channel while
// the buses run. Bridge and station are separate processes; the station is ours, or one on Cyclone
// DDS (tests/interop/dds/join.c, if tests are built).
//
// usage: join_bench [--buses N] [--channels N] [--joins N] [--way NAME]
//                   [--patience SECONDS]
// Default of --buses: 8, 16 and 64 of 1 000 channels. Each way joins N times (2): blocks, samples,
// best-effort (samples too), cyclone-blocks, cyclone-samples.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/stations.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {
namespace {

struct Options {
  int channels = 1000;  // of each bus
  int joins = 2;
  std::string way;       // empty: all
  double patience = 30;  // seconds
};

struct Way {
  const char* name;
  const char* program;
  const char* argument;
};
constexpr Way kWays[] = {{"blocks", "bench_station", "by-blocks"},
                         {"samples", "bench_station", "one-by-one"},
                         {"best-effort", "bench_station", "best-effort"},
                         {"cyclone-blocks", "cyclone-join", "by-blocks"},
                         {"cyclone-samples", "cyclone-join", "one-by-one"}};

class Course {
 public:
  explicit Course(std::size_t stations) : stations_(static_cast<double>(stations)) {}

  void show(double share_of_this_one) {
    line_.show([&](Duration elapsed) {
      return progress_text("joining", (joined_ + share_of_this_one) / stations_, elapsed);
    });
  }
  void next() {
    ++joined_;
    line_.clear();
  }

 private:
  double stations_, joined_ = 0;
  ProgressLine line_{std::cerr};
};

void join(const Options& options, const ScratchFolder& folder, unsigned domain, int buses,
          const Way& way, const std::string& name, const Process& bridge, Course& course) {
  const auto all = static_cast<std::uint64_t>(buses) * static_cast<std::uint64_t>(options.channels);
  const auto begun = Clock::now();
  const double cpu = bridge.cpu_seconds();
  const StationProcess station(folder, domain, name, way.argument, 0, way.program);
  double listed = 0, complete = 0;
  Received received;
  while (seconds_since(begun) < options.patience) {
    received = station.received();
    if (listed == 0 && received.listed >= all) listed = seconds_since(begun);
    if (complete == 0 && received.channels >= all) complete = seconds_since(begun);
    if (listed > 0 && complete > 0) break;
    course.show(static_cast<double>(received.listed + received.channels) /
                static_cast<double>(2 * all));
    let_run(0.02);
  }
  course.next();
  std::printf("%s: %llu of %llu channels listed, %llu with a value\n", way.name,
              static_cast<unsigned long long>(received.listed),
              static_cast<unsigned long long>(all),
              static_cast<unsigned long long>(received.channels));
  print_figure("  start of the process to the whole catalogue", listed, "s", "0: never");
  print_figure("  start of the process to every last value", complete, "s",
               "goal < 1 with 16 000, < 3 with 64 000");
  print_figure("  processor time of the station until then", station.cpu_seconds(), "s");
  print_figure("  processor time of the bridge until then", bridge.cpu_seconds() - cpu, "s");
}

void measure(const Options& options, int buses) {
  std::printf("== %d buses of %d channels\n", buses, options.channels);
  const ScratchFolder folder;
  const unsigned domain = own_domain();
  const std::string log = folder.path() + "/bridge.log";
  const Process bridge(
      "bench_bridge",
      {std::to_string(domain), std::to_string(buses), std::to_string(options.channels)}, log);
  if (!wait_for_text(log, "published", 60)) throw std::runtime_error("the bridge does not publish");
  let_run(1);
  std::vector<Way> ways(std::begin(kWays), std::end(kWays));
  std::erase_if(ways, [&](const Way& way) {
    return !has_program(way.program) || (!options.way.empty() && options.way != way.name);
  });
  int number = 0;
  Course course(ways.size() * static_cast<std::size_t>(std::max(options.joins, 0)));
  for (const Way& way : ways) {
    for (int i = 0; i < options.joins; ++i)
      join(options, folder, domain, buses, way, "station-" + std::to_string(++number), bridge,
           course);
  }
  print_figure("  resident memory of the bridge", bridge.resident_mb(), "MB",
               "goal < 300 with 64 000");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("join_bench", argc, argv, [](const Arguments& arguments) {
    const Options options{.channels = arguments.number("--channels", 1000),
                          .joins = arguments.number("--joins", 2),
                          .way = arguments.text("--way"),
                          .patience = arguments.number("--patience", 30.0)};
    const int buses = arguments.number("--buses", 0);
    for (const int each : buses > 0 ? std::vector{buses} : std::vector{8, 16, 64})
      measure(options, each);
  });
}

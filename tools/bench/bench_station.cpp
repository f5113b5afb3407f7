// A station in its own process: subscribes to every sample and prints totals every 20 ms.
//
// usage: bench_station DOMAIN one-by-one|by-blocks [SHARE OF DATAGRAMS LOST]
//
// Each line: samples received, samples missing by sequence, channels with a value, channels of the
// catalogue, blocks missing.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <thread>
#include <unordered_map>

#include "bridge/station/station.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/lossy_receive.hpp"

namespace fieldcast::bench {
namespace {

std::atomic<bool> stopped = false;

// Counts samples of a subscription; written by one thread, read by another.
class Count {
 public:
  void add(const StationSample& sample) {
    path_.assign(sample.bus)
        .append(1, '/')
        .append(sample.device)
        .append(1, '/')
        .append(sample.channel);
    std::uint64_t& last = last_[path_];
    if (last == 0) ++channels;
    // A restarted bus counts from 1 again.
    if (last != 0 && sample.sequence > last + 1) missing += sample.sequence - last - 1;
    last = sample.sequence;
    ++samples;
  }
  std::atomic<std::uint64_t> samples = 0, missing = 0, channels = 0, listed = 0;

 private:
  std::string path_;
  std::unordered_map<std::string, std::uint64_t> last_;
};

void run(unsigned domain, bool one_by_one) {
  Count count;
  DdsSpec dds;
  dds.domain = domain;
  Station station(dds, "bench_station");
  station.subscribe_channels([&](const StationChannel&) { ++count.listed; });
  station.subscribe_samples([&](const StationSample& sample) { count.add(sample); }, {},
                            {.deadline = {}, .on_deadline_missed = {}, .one_by_one = one_by_one});
  while (!stopped) {
    fmt::print("{} {} {} {} {}\n", count.samples.load(), count.missing.load(),
               count.channels.load(), count.listed.load(), station.block_counters().missing);
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  const Arguments arguments(argc, argv);
  if (arguments.size() < 1) return 2;
  std::signal(SIGTERM, [](int) { stopped = true; });
  return run_bench("bench_station", [&] {
    lose(arguments.number_at(2, 0.0));
    run(arguments.number_at(0, 0u), arguments.text_at(1) == "one-by-one");
  });
}

// A station in its own process: subscribes to every sample and prints totals every 20 ms.
//
// usage: bench_station DOMAIN one-by-one|by-blocks [SHARE OF DATAGRAMS LOST]
//
// Each line: samples received, samples missing by sequence, channels with a value, channels of the
// catalogue, blocks missing.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <thread>
#include <unordered_map>

#include "bridge/station/station.hpp"
#include "tools/bench/support/lossy_receive.hpp"

namespace fieldcast::bench {
namespace {

std::atomic<bool> stopped = false;

// Counts samples of a subscription; written by one thread, read by another.
class Count {
 public:
  void add(const StationSample& sample) {
    path_ = sample.bus;
    path_ += '/';
    path_ += sample.device;
    path_ += '/';
    path_ += sample.channel;
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

int run(unsigned domain, bool one_by_one) {
  Count count;
  DdsSpec dds;
  dds.domain = domain;
  Station station(dds, "bench_station");
  station.subscribe_channels([&](const StationChannel&) { ++count.listed; });
  station.subscribe_samples([&](const StationSample& sample) { count.add(sample); }, {},
                            {.deadline = {}, .on_deadline_missed = {}, .one_by_one = one_by_one});
  while (!stopped) {
    std::printf("%llu %llu %llu %llu %llu\n", static_cast<unsigned long long>(count.samples),
                static_cast<unsigned long long>(count.missing),
                static_cast<unsigned long long>(count.channels),
                static_cast<unsigned long long>(count.listed),
                static_cast<unsigned long long>(station.block_counters().missing));
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return 0;
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  std::signal(SIGTERM, [](int) { fieldcast::bench::stopped = true; });
  try {
    if (argc > 3) fieldcast::bench::lose(std::atof(argv[3]));
    return fieldcast::bench::run(static_cast<unsigned>(std::atoi(argv[1])),
                                 argc > 2 && std::strcmp(argv[2], "one-by-one") == 0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_station: %s\n", error.what());
    return 1;
  }
}

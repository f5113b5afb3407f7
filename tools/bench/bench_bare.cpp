// A bare Fast DDS writer or reader (bare.hpp) in its own process. Prints the number of written or
// received samples every 20 ms.
//
// usage: bench_bare DOMAIN blocks|samples write CHANNELS ROWS MICROSECONDS
//        bench_bare DOMAIN blocks|samples read
//
// ROWS: samples of a block, or samples written one after the other. The next round starts
// MICROSECONDS after the start of the previous one.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <thread>

#include "tools/bench/plant/bare.hpp"

namespace fieldcast::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kReport{20};

std::atomic<bool> stopped = false;

void say(std::uint64_t samples) {
  std::printf("%llu\n", static_cast<unsigned long long>(samples));
  std::fflush(stdout);
}

void write(BareWriter& writer, std::size_t rows, std::chrono::microseconds period) {
  std::uint64_t number = 0;
  Clock::time_point due = Clock::now(), report = due;
  while (!stopped) {
    writer.write(rows, ++number);
    if (due >= report) {
      say(number * rows);
      report = due + kReport;
    }
    due += period;
    std::this_thread::sleep_until(due);
  }
}

void read(unsigned domain, BareData data) {
  std::atomic<std::uint64_t> samples = 0;
  const BareReader reader(domain, data, [&](const BareReader::Row&) { ++samples; });
  while (!stopped) {
    say(samples);
    std::this_thread::sleep_for(kReport);
  }
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  if (argc < 4) return 2;
  std::signal(SIGTERM, [](int) { stopped = true; });
  try {
    const auto domain = static_cast<unsigned>(std::atoi(argv[1]));
    const BareData data = std::string(argv[2]) == "blocks" ? BareData::kBlocks : BareData::kSamples;
    if (std::string(argv[3]) == "read") {
      read(domain, data);
    } else if (argc == 7) {
      BareWriter writer(domain, data, static_cast<std::size_t>(std::atoi(argv[4])));
      write(writer, static_cast<std::size_t>(std::atoi(argv[5])),
            std::chrono::microseconds(std::atoi(argv[6])));
    } else {
      return 2;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_bare: %s\n", error.what());
    return 1;
  }
  return 0;
}

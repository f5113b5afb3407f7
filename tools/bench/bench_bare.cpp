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
#include <thread>

#include "tools/bench/plant/bare.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

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
  const Arguments arguments(argc, argv);
  const bool reads = arguments.text_at(2) == "read";
  if (arguments.size() != (reads ? 3 : 6)) return 2;
  std::signal(SIGTERM, [](int) { stopped = true; });
  return run_bench("bench_bare", [&] {
    const auto domain = arguments.number_at(0, 0u);
    const auto data = arguments.text_at(1) == "blocks" ? BareData::kBlocks : BareData::kSamples;
    if (reads) return read(domain, data);
    BareWriter writer(domain, data, arguments.number_at(3, std::size_t{}));
    write(writer, arguments.number_at(4, std::size_t{}),
          std::chrono::microseconds(arguments.number_at(5, 0)));
  });
}

// S7 freeport on a noisy line: how often a wrong value is published, compared with the theoretical
// minimum of its XOR check.
//
// usage: freeport_bench [exchanges]     (default: 10 million; virtual time)
#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "tests/bus/freeport_bus.hpp"
#include "tests/bus/freeport_pairs.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/progress/progress_line.hpp"

namespace {

using namespace fieldcast;

constexpr unsigned kStations = 8;
constexpr double kRate = 1e-4;
constexpr Duration kResponseTime = std::chrono::milliseconds{5};  // one scan of the PLC

void print_run(const char* line, double rate, std::uint64_t exchanges) {
  test::FreeportBus bus(kStations, rate, 2026, kResponseTime);
  {
    constexpr std::uint64_t kPart = 10'000;
    ProgressLine progress(std::cerr);
    while (bus.counts().exchanges < exchanges) {
      const std::uint64_t done = bus.counts().exchanges;
      bus.run(std::min(kPart, exchanges - done));
      progress.show([&](Duration elapsed) {
        return progress_text(line, static_cast<double>(done) / static_cast<double>(exchanges),
                             elapsed);
      });
    }
  }
  const test::FreeportBus::Counts& counts = bus.counts();
  const double seconds = to_seconds(bus.elapsed());
  fmt::print("{} line: {} exchanges in {:.0f} s of virtual time, {} bits flipped\n", line,
             counts.exchanges, seconds, bus.flipped());
  const auto all = static_cast<double>(counts.exchanges);
  bench::print_figure("  exchanges a second", all / seconds, "1/s");
  bench::print_figure("  right values a second", static_cast<double>(counts.right) / seconds,
                      "1/s");
  const CauseCounters causes = bus.causes();
  bench::print_figure("  exchanges that failed, of all", static_cast<double>(causes.total()) / all,
                      "", rate > 0 ? "" : "0");
  for (unsigned i = 1; i < static_cast<unsigned>(Cause::kCount); ++i) {
    const auto cause = static_cast<Cause>(i);
    if (causes[cause] > 0) fmt::print("    {:20} {}\n", to_text(cause), causes[cause]);
  }
  bench::print_figure("  wrong values published", counts.wrong, "", rate > 0 ? "" : "0");
  bench::print_figure("  wrong values, of all exchanges", static_cast<double>(counts.wrong) / all,
                      "", rate > 0 ? "at most 1e-06" : "0");
}

void print_limit() {
  const test::FreeportPairs pairs = test::count_freeport_pairs(kStations, 400, 7);
  fmt::print(
      "pairs of bits that turn an exchange into a wrong value, of {} stations with random "
      "windows\n",
      kStations);
  bench::print_figure("  in the response, unseen by any receiver with this check",
                      pairs.check_allows, "pairs");
  bench::print_figure("  in the response, taken by our decoder", pairs.taken, "pairs", "the same");
  bench::print_figure("  in the request, so that another station responds", pairs.misled, "pairs");
  bench::print_figure("  single bits", pairs.single, "bits", "0");
  bench::print_figure("  the limit at 1e-4: wrong values, of all exchanges",
                      test::wrong_share(pairs.check_allows + pairs.misled, kRate));
}

}  // namespace

int main(int argc, char** argv) {
  const auto exchanges = bench::Arguments(argc, argv).number_at(0, std::uint64_t{10'000'000});
  fmt::print(
      "S7 freeport, {} stations, 9600 baud 8N1, responses after 5 ms, every value new; each bit "
      "flipped with 1e-4\n",
      kStations);
  print_limit();
  print_run("clean", 0, exchanges / 10);
  print_run("noisy", kRate, exchanges);
}

// Late, doubled and foreign responses with every protocol in virtual time: counts wrong good
// values. Asserts nothing; tests/bus/late_test.cpp is the short version.
//
//     storm_bench [EXCHANGES] [PROTOCOL]     of each protocol, default a million
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "tests/bus/late_storm.hpp"
#include "tools/progress/progress_line.hpp"

using namespace fieldcast;
using namespace std::chrono_literals;

int main(int count, char** arguments) {
  const std::uint64_t exchanges = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1'000'000;
  const std::string only = count > 2 ? arguments[2] : "";
  constexpr std::uint64_t kRun = 20'000;  // then changes the delay and the seed
  constexpr Duration kLate[] = {80ms, 150ms, 205ms, 250ms, 320ms, 450ms, 560ms};
  std::printf("timeout 200 ms; 5 %% of the responses late by 80 to 560 ms, 2 %% doubled\n");
  std::printf("%-24s %10s %9s %9s %12s %9s %6s\n", "protocol", "exchanges", "late", "doubled",
              "good values", "commands", "wrong");
  test::LateStorm::Counts all;
  for (const test::StormKind& kind : test::storm_kinds()) {
    if (!only.empty() && kind.name.find(only) == std::string::npos) continue;
    const BusSpec spec = test::bus_of(kind, "200ms");
    test::LateStorm::Counts sum;
    ProgressLine progress(std::cerr);
    for (std::uint64_t run = 0; sum.exchanges < exchanges; ++run) {
      test::StormFaults faults{.late = 0.05, .by = kLate[run % std::size(kLate)], .doubled = 0.02};
      if (kind.foreign) faults.foreign = 0.2;
      progress.show([&](Duration elapsed) {
        return progress_text(kind.name,
                             static_cast<double>(sum.exchanges) / static_cast<double>(exchanges),
                             elapsed);
      });
      test::LateStorm storm(kind, spec, test::faults_of(spec, faults), run + 1);
      storm.run(std::min(kRun, exchanges - sum.exchanges));
      const auto counts = storm.counts();
      sum.exchanges += counts.exchanges;
      sum.late += counts.late;
      sum.doubled += counts.doubled;
      sum.good += counts.good;
      sum.commands += counts.commands;
      sum.wrong += counts.wrong;
      if (!counts.first_wrong.empty())
        std::printf("  seed %llu: %s\n", static_cast<unsigned long long>(run) + 1,
                    counts.first_wrong.c_str());
    }
    progress.clear();
    std::printf(
        "%-24s %10llu %9llu %9llu %12llu %9llu %6llu\n", kind.name.c_str(),
        static_cast<unsigned long long>(sum.exchanges), static_cast<unsigned long long>(sum.late),
        static_cast<unsigned long long>(sum.doubled), static_cast<unsigned long long>(sum.good),
        static_cast<unsigned long long>(sum.commands), static_cast<unsigned long long>(sum.wrong));
    std::fflush(stdout);
    all.exchanges += sum.exchanges;
    all.late += sum.late;
    all.wrong += sum.wrong;
  }
  std::printf("%llu exchanges, %llu late responses, %llu wrong good values\n",
              static_cast<unsigned long long>(all.exchanges),
              static_cast<unsigned long long>(all.late),
              static_cast<unsigned long long>(all.wrong));
  return all.wrong == 0 ? 0 : 1;
}

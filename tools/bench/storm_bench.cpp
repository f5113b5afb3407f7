// Late, doubled and foreign responses with every protocol in virtual time: counts wrong good
// values. Asserts nothing; tests/bus/late_test.cpp is the short version.
//
//     storm_bench [EXCHANGES] [PROTOCOL]     of each protocol, default a million
#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <string>

#include "tests/bus/late_storm.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/progress/progress_line.hpp"

using namespace fieldcast;
using namespace std::chrono_literals;

int main(int argc, char** argv) {
  const bench::Arguments given(argc, argv);
  const auto exchanges = given.number_at(0, std::uint64_t{1'000'000});
  const std::string only = given.text_at(1);
  constexpr std::uint64_t kRun = 20'000;  // then changes the delay and the seed
  constexpr Duration kLate[] = {80ms, 150ms, 205ms, 250ms, 320ms, 450ms, 560ms};
  fmt::print("timeout 200 ms; 5 % of the responses late by 80 to 560 ms, 2 % doubled\n");
  fmt::print("{:24} {:>10} {:>9} {:>9} {:>12} {:>9} {:>6}\n", "protocol", "exchanges", "late",
             "doubled", "good values", "commands", "wrong");
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
      if (!counts.first_wrong.empty()) fmt::print("  seed {}: {}\n", run + 1, counts.first_wrong);
    }
    progress.clear();
    fmt::print("{:24} {:10} {:9} {:9} {:12} {:9} {:6}\n", kind.name, sum.exchanges, sum.late,
               sum.doubled, sum.good, sum.commands, sum.wrong);
    std::fflush(stdout);
    all.exchanges += sum.exchanges;
    all.late += sum.late;
    all.wrong += sum.wrong;
  }
  fmt::print("{} exchanges, {} late responses, {} wrong good values\n", all.exchanges, all.late,
             all.wrong);
  return all.wrong == 0 ? 0 : 1;
}

// `fieldcast plan CONFIG`: calculates the bus load; with --simulate runs the whole engine in
// virtual time. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "core/schedule/bus_schedule.hpp"
#include "tools/cli/text/exit_code.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

struct PlanOptions {
  std::string config;
  bool json = false;
  Duration answer_time = kAssumedAnswerTime;
  Duration simulate{};  // virtual time with simulated devices; 0: only plan
  std::uint64_t seed = 1;
  std::string faults;  // file with the faults of the simulated plant; empty: none
};

// Returns kFound if a bus cannot keep its refresh times, kUsage if a file has faults.
[[nodiscard]] ExitCode plan(const PlanOptions& options, std::ostream& out, std::ostream& err,
                            const Screen& screen);

}  // namespace fieldcast::cli

// `fieldcast plan CONFIG`: what the wire will have to carry, before anything is connected; with
// --simulate the whole engine of each bus in virtual time. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "core/schedule/bus_schedule.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

struct PlanOptions {
  std::string config;
  bool json = false;
  Duration answer_time = kAssumedAnswerTime;
  Duration simulate{};  // virtual time against simulated devices; 0: only plan
  std::uint64_t seed = 1;
  std::string faults;  // file with what goes wrong in the simulated plant; empty: nothing
};

// kOk, kFound when some bus cannot keep its promises, kUsage when a file has faults.
[[nodiscard]] ExitCode plan(const PlanOptions& options, std::ostream& out, std::ostream& err,
                            const Screen& screen);

}  // namespace fieldcast::cli

// `fieldcast plan CONFIG`: what the wire will have to carry, before anything is connected. Needs no DDS.
#pragma once

#include <iosfwd>
#include <string>

#include "core/base/time.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/text_table.hpp"

namespace fieldcast::cli {

struct PlanOptions {
  std::string config;
  bool json = false;
  Duration answer_time =
      std::chrono::milliseconds{5};  // of every device, from the end of a request to the first byte of its answer
};

// kOk, kFound when some bus cannot keep its promises, kUsage when the file has faults.
[[nodiscard]] ExitCode plan(const PlanOptions& options, std::ostream& out, std::ostream& err, const Screen& screen);

}  // namespace fieldcast::cli

// `fieldcast alarms`: which limits are passed now, from the bridges; with a time, what the store
// knows of then.
#pragma once

#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "bridge/station/station.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/store_source.hpp"

namespace fieldcast::cli {

struct AlarmsOptions {
  ConnectionOptions connection;
  StoreSource source;
  std::optional<TimeSpan> span;  // of the store; nothing: now, from the bridges
  bool json = false;             // the present alarms that are clear too
};

// kOk when a bridge was there (also without any alarm), else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode alarms(const AlarmsOptions& options, const DdsSpec& spec,
                              Interrupt& interrupt, std::ostream& out, std::ostream& err);
// kOk when there were some, else kNothing. Throws StoreError.
[[nodiscard]] ExitCode stored_alarms(const AlarmsOptions& options, std::ostream& out,
                                     std::ostream& err);

}  // namespace fieldcast::cli

// `fieldcast alarms`: which limits are passed now and what people did about that, from the bridges;
// with a time, what the store knows of then. `alarms ack`, `shelve`, `unshelve`, `maintenance`: do
// something about them.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "bridge/station/station.hpp"
#include "core/model/pattern.hpp"
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
  // Nothing: they are shown.
  std::optional<AlarmActionKind> action;
  Pattern pattern;                 // of the channels, or of the device
  std::optional<LimitKind> limit;  // nothing: all of them
  Duration duration{};
  std::string note;
};

// kOk when a bridge was there (also without any alarm), else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode alarms(const AlarmsOptions& options, const Connection& connection,
                              Interrupt& interrupt, std::ostream& out, std::ostream& err);
// Acts in the name of `by`. kNothing when no alarm is meant; else the code of the worst result.
// Throws DdsError. REQUIRES: an action.
[[nodiscard]] ExitCode act_on_alarms(const AlarmsOptions& options, const std::string& by,
                                     const Connection& connection, Interrupt& interrupt,
                                     std::ostream& out, std::ostream& err);
// kOk when there were some, else kNothing. Throws StoreError.
[[nodiscard]] ExitCode stored_alarms(const AlarmsOptions& options, std::ostream& out,
                                     std::ostream& err);

}  // namespace fieldcast::cli

// `fieldcast alarms`: shows active alarms of the bridges, or alarms of a time span from the store.
// `alarms ack`, `shelve`, `unshelve` and `maintenance` act on alarms.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "bridge/station/station.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct AlarmsOptions {
  ConnectionOptions connection;
  StoreSource source;
  std::optional<TimeSpan> span;  // of the store; empty: current alarms of the bridges
  bool json = false;             // also lists current alarms that are clear
  // Empty to show the alarms.
  std::optional<AlarmActionKind> action;
  Pattern pattern;                 // of the channels or the device
  std::optional<LimitKind> limit;  // empty: all limits
  Duration duration{};
  std::string note;
};

// Returns kOk if a bridge reported, with or without alarms, else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode alarms(const AlarmsOptions& options, const Connection& connection,
                              Interrupt& interrupt, std::ostream& out, std::ostream& err);
// `by`: the acting user. kNothing if no alarm matches, else the worst result. Throws DdsError.
// REQUIRES: options.action is set.
[[nodiscard]] ExitCode act_on_alarms(const AlarmsOptions& options, const std::string& by,
                                     const Connection& connection, Interrupt& interrupt,
                                     std::ostream& out, std::ostream& err);
// Returns kOk if alarms were found, else kNothing. Throws StoreError.
[[nodiscard]] ExitCode stored_alarms(const AlarmsOptions& options, std::ostream& out,
                                     std::ostream& err);

}  // namespace fieldcast::cli

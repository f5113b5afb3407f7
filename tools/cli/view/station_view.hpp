// Formats alarms as text and JSON with IDL field names. Pure functions.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/store/records/records.hpp"
#include "core/base/json.hpp"
#include "core/model/status.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// An alarm from both topics. An older bridge sends only the first.
struct KnownAlarm {
  std::optional<StationAlarm> alarm;
  std::optional<AlarmStatus> status;
  [[nodiscard]] bool active() const;
  // The alarm is active, not acknowledged, shelved or suppressed.
  [[nodiscard]] bool is_shown() const;
};
using KnownAlarms = std::map<AlarmKey, KnownAlarm>;

// Alarms with is_shown(), most urgent first: not acknowledged, then by priority and age.
[[nodiscard]] std::vector<std::string> alarm_lines(const KnownAlarms& alarms, UtcTime now,
                                                   const Screen& screen);
[[nodiscard]] Json alarm_json(const AlarmKey& key, const KnownAlarm& known);

[[nodiscard]] std::string alarm_line(const AlarmLogEntry& entry);
[[nodiscard]] Json record_json(const AlarmLogEntry& entry);

using SessionsModel = std::map<std::pair<std::string, std::string>, ProgramSessionReport>;

[[nodiscard]] std::vector<std::string> sessions_lines(const SessionsModel& model, UtcTime now,
                                                      const Screen& screen);

// The fields of ProgramSession by their IDL names. Times in nanoseconds.
[[nodiscard]] Json session_json(const ProgramSessionReport& session);

// Columns of a channel: path, value, unit, quality, age, refresh, rate. `about` may be null.
using ChannelCells = std::array<Cell, 7>;
[[nodiscard]] ChannelCells channel_cells(const ChannelPath& path, const WatchModel::Row& row,
                                         const StationChannel* about, const Moment& moment);

// Totals, heads, and the channels sorted by name. Rows that do not fit are counted below. The lag
// remark is last. `now` and `utc` are the same moment.
[[nodiscard]] std::vector<std::string> watch_lines(const WatchModel& model, Instant now,
                                                   UtcTime utc, const Screen& screen);

// This station is too slow: {"event":"too_slow","blocks_missed","last_values_requests"}.
[[nodiscard]] Json lag_json(const Station::BlockCounters& counters);

}  // namespace fieldcast::cli

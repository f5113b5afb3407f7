// Formats alarms as text and JSON with IDL field names. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/store/records/records.hpp"
#include "core/base/json.hpp"
#include "tools/cli/text/text_table.hpp"

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

}  // namespace fieldcast::cli

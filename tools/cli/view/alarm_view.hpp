// Alarms and what people did about them, as lines for people and JSON. Field names are those of the
// IDL where it has them. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/store/records.hpp"
#include "core/base/json.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// What the two topics say of one alarm. An older bridge has the first one only.
struct KnownAlarm {
  std::optional<StationAlarm> alarm;
  std::optional<AlarmStatus> status;
  [[nodiscard]] bool active() const;
  // Somebody has to know of it: it is active, not acknowledged, or put aside.
  [[nodiscard]] bool is_shown() const;
};
using KnownAlarms = std::map<AlarmKey, KnownAlarm>;

// Those that are shown, the most urgent first: what is not acknowledged, by priority and age.
[[nodiscard]] std::vector<std::string> alarm_lines(const KnownAlarms& alarms, UtcTime now,
                                                   const Screen& screen);
[[nodiscard]] Json alarm_json(const AlarmKey& key, const KnownAlarm& known);

[[nodiscard]] std::string alarm_line(const AlarmLogEntry& entry);
[[nodiscard]] Json record_json(const AlarmLogEntry& entry);

}  // namespace fieldcast::cli

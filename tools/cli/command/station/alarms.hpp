#pragma once

#include <optional>
#include <string>

#include "bridge/station/station.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/domain/connection.hpp"

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
  std::optional<Duration> maintenance;  // with `end`: of `alarms maintenance`, for `duration`
  bool end = false;
  std::string note;
};

}  // namespace fieldcast::cli

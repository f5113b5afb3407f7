// A bus from the text of a configuration, as the input of the planner. For golden texts.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/protocol/protocol.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast::test {

struct LoadedBus {
  // Loads the first bus of the configuration. Throws std::runtime_error with its faults.
  explicit LoadedBus(const std::string& text);

  // "press-1/a"; with several channels on the same items "press-1/a+b".
  [[nodiscard]] std::string name(PointIndex point) const;
  // Index of a device, or of the point of a channel, by name. Throws if there is none.
  [[nodiscard]] DeviceIndex device(const std::string& name) const;
  [[nodiscard]] PointIndex point(const std::string& name) const;
  void set_response_time(Duration time);

  BusSpec bus;
  std::vector<std::unique_ptr<Protocol>> protocols;
  PointMap map;
  ScheduleInput input;  // lead and silence as in the engine
};

// "94.000": milliseconds with three decimals.
[[nodiscard]] std::string ms_text(Duration time);
// "12.3 %"
[[nodiscard]] std::string percent_text(double share);
// Shortest text with at most four decimals.
[[nodiscard]] std::string factor_text(double factor);
// The words of a line.
[[nodiscard]] std::vector<std::string> words_of(const std::string& line);
// "100ms", "2.5s", "250us"; throws std::runtime_error.
[[nodiscard]] Duration duration_of(const std::string& text);

}  // namespace fieldcast::test

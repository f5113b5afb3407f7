// One limit of one channel: raised when good values stay beyond it for the delay, clear when a good
// value is back inside by the hysteresis. Pure.
//
//   clear --beyond--> waiting --beyond for the delay--> active --inside by the hysteresis--> clear
//            ^-----------inside--------'
//
// A value that is not good says nothing: it raises nothing and clears nothing, and an alarm that is
// active stays so. While the newest value is not good, a delay goes on, but only the next good
// value can end it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

enum class LimitKind : std::uint8_t { kLowLow, kLow, kHigh, kHighHigh };
[[nodiscard]] std::string_view to_text(LimitKind kind);  // "low-low", ...
[[nodiscard]] std::optional<LimitKind> limit_kind_from(std::string_view text);

enum class AlarmState : std::uint8_t { kClear, kActive };
[[nodiscard]] std::string_view to_text(AlarmState state);  // "clear", "active"

class LimitWatch {
 public:
  LimitWatch(LimitKind kind, double limit, double hysteresis, Duration delay)
      : kind_(kind), limit_(limit), hysteresis_(hysteresis), delay_(delay) {}

  // Each returns true when the state changed: state(), value() and since() show the new one.
  [[nodiscard]] bool on_good(double value, Instant acquired, Instant now);  // NaN is not good
  void on_bad() { trusted_ = false; }
  [[nodiscard]] bool on_time(Instant now);
  // The alarm was active before this watch began, since then and with that value: it goes on, with
  // its own beginning, or ends at the newest good value if that is back inside.
  void restore(double value, Instant since);

  [[nodiscard]] LimitKind kind() const { return kind_; }
  [[nodiscard]] AlarmState state() const { return state_; }
  // The value that changed the state.
  [[nodiscard]] double value() const { return value_; }
  // When the first value beyond the limit, or the first one back inside, was acquired.
  [[nodiscard]] Instant since() const { return since_; }
  [[nodiscard]] bool waiting() const { return beyond_since_ && state_ == AlarmState::kClear; }

 private:
  [[nodiscard]] bool beyond(double value) const;
  [[nodiscard]] bool back_inside(double value) const;
  [[nodiscard]] bool raise_if_due(Instant now);

  LimitKind kind_;
  double limit_;
  double hysteresis_;
  Duration delay_;
  AlarmState state_ = AlarmState::kClear;
  std::optional<Instant> beyond_since_;
  bool trusted_ = false;  // the newest value is good
  double value_ = 0;
  Instant since_{};
  std::optional<double> newest_;  // the newest good value
  Instant newest_at_{};           // when it was acquired
};

}  // namespace fieldcast

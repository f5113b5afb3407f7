// One limit of one channel: raised if good values stay beyond it for the delay, cleared if a good
// value is back inside by the hysteresis. Pure.
//
//   clear --beyond--> waiting --beyond for the delay--> active --inside by the hysteresis--> clear
//            ^-----------inside--------'
//
// A value that is not good neither raises nor clears. While the newest value is not good, a delay
// continues, but only the next good value can end it.
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

  // Each returns true if the state changed; then state(), value() and since() are updated.
  [[nodiscard]] bool on_good(double value, Instant acquired, Instant now);  // NaN is not good
  void on_bad() { trusted_ = false; }
  [[nodiscard]] bool on_time(Instant now);
  // The alarm continues, or ends at the newest good value if that is back inside.
  void restore(double value, Instant since);

  [[nodiscard]] LimitKind kind() const { return kind_; }
  [[nodiscard]] AlarmState state() const { return state_; }
  [[nodiscard]] double value() const { return value_; }
  // Acquisition time of the first value beyond the limit, or back inside.
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
  Instant newest_at_{};           // its acquisition time
};

}  // namespace fieldcast

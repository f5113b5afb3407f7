// The states of one alarm, by the diagram of ANSI/ISA-18.2 with its letters. Pure: `now` is a
// parameter.
//
//   normal (A) --occurs--> unacknowledged (B) --acknowledge--> acknowledged (C) --returns--> normal
//   unacknowledged --returns--> returned (D) --acknowledge--> normal;  returned --occurs--> (B)
//   any of them --shelve--> shelved (G);  any --remove from service--> out of service (I)
//
// An alarm that returns from G or I is unacknowledged if its limit is exceeded, even if it was
// acknowledged before, and normal otherwise. In G and I, occurrences are recorded without a change
// of state, and the alarm cannot be acknowledged. Latching (E, F) and suppression by design (H) are
// not supported.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/alarm/alarm_status.hpp"
#include "core/base/cause.hpp"

namespace fieldcast {

enum class IsaState : std::uint8_t {
  kNormal,
  kUnacknowledged,
  kAcknowledged,
  kReturned,
  kShelved,
  kOutOfService,
};
enum class IsaInput : std::uint8_t {
  kOccurs,
  kReturns,
  kAcknowledge,
  kShelve,
  kUnshelveInAlarm,
  kUnshelveNormal,
  kRemoveFromService,
  kReturnToServiceInAlarm,
  kReturnToServiceNormal,
  kReturnToServiceShelved,
};

struct IsaTransition {
  IsaState from;
  IsaInput input;
  IsaState to;
  std::string_view name;  // "re-alarm"
};
// Complete: other inputs change no state.
[[nodiscard]] std::span<const IsaTransition> isa_transitions();
[[nodiscard]] std::optional<IsaState> next_state(IsaState from, IsaInput input);

struct AlarmRefusal {
  Cause cause = Cause::kWrongState;
  std::string reason;  // one human-readable line
};
using AlarmOutcome = tl::expected<void, AlarmRefusal>;

class AlarmLife {
 public:
  static constexpr Duration kChatterWindow = std::chrono::minutes{10};
  static constexpr std::size_t kChatterFrom = 5, kChatterUntil = 2;  // occurrences in the window
  static constexpr std::size_t kMaxCounted = 1000;                   // limit of counted occurrences

  explicit AlarmLife(AlarmPriority priority) { status_.priority = priority; }

  [[nodiscard]] const AlarmStatus& status() const { return status_; }
  [[nodiscard]] IsaState state() const { return state_; }
  void set_priority(AlarmPriority priority) { status_.priority = priority; }

  // The limit is exceeded, or no longer. No effect if it was so before.
  void raise(double value, UtcTime since, UtcTime now);
  void clear(double value, UtcTime since);

  // `raised_at`: the acknowledged occurrence; 0: any.
  [[nodiscard]] AlarmOutcome acknowledge(AlarmNote note, UtcTime raised_at);
  // A shelved alarm gets the new end.
  void shelve(AlarmPause pause);
  [[nodiscard]] AlarmOutcome unshelve();
  // Maintenance of its device. Both may be repeated.
  void suppress(AlarmPause pause);
  void end_suppression();

  // Drops old occurrences. Returns true if the status changed.
  bool count(UtcTime now);

  // `occurrences`: start times of the last minutes, in order.
  void restore(const AlarmStatus& kept, std::span<const UtcTime> occurrences, UtcTime now);

 private:
  bool take(IsaInput input);

  IsaState state_ = IsaState::kNormal;
  AlarmStatus status_;
  std::deque<UtcTime> raised_;  // in the window; at most kMaxCounted
};

}  // namespace fieldcast

// One alarm through its life, by the state diagram of ANSI/ISA-18.2, whose letters stand below.
// Pure: `now` is passed in. Who keeps many of them: alarm_book.hpp.
//
//   normal (A) --occurs--> unacknowledged (B) --acknowledge--> acknowledged (C) --returns--> normal
//   unacknowledged --returns--> returned (D) --acknowledge--> normal;  returned --occurs--> (B)
//   any of them --shelve--> shelved (G);  any --remove from service--> out of service (I)
//
// What is shelved or out of service comes back unacknowledged if its limit is passed then, whoever
// had acknowledged it before, and normal if not. While it is away, occurrences are noted but
// change no state, and nobody can acknowledge it. Latching (E, F) and suppression by design (H) do
// not exist here.
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
// All there are: whatever is not in the table changes nothing.
[[nodiscard]] std::span<const IsaTransition> isa_transitions();
[[nodiscard]] std::optional<IsaState> next_state(IsaState from, IsaInput input);

// Why something is not done.
struct AlarmRefusal {
  Cause cause = Cause::kWrongState;
  std::string reason;  // one line for people
};
using AlarmOutcome = tl::expected<void, AlarmRefusal>;

class AlarmLife {
 public:
  static constexpr Duration kChatterWindow = std::chrono::minutes{10};
  static constexpr std::size_t kChatterFrom = 5, kChatterUntil = 2;  // occurrences in the window
  static constexpr std::size_t kMaxCounted = 1000;                   // more are not counted

  explicit AlarmLife(AlarmPriority priority) { status_.priority = priority; }

  [[nodiscard]] const AlarmStatus& status() const { return status_; }
  [[nodiscard]] IsaState state() const { return state_; }
  void set_priority(AlarmPriority priority) { status_.priority = priority; }

  // The limit is passed, or kept again. No effect if it was so before.
  void raise(double value, UtcTime since, UtcTime now);
  void clear(double value, UtcTime since);

  // `raised_at`: the occurrence that is meant; 0: any.
  [[nodiscard]] AlarmOutcome acknowledge(AlarmNote note, UtcTime raised_at);
  // One that is shelved already gets the new end.
  void shelve(AlarmPause pause);
  [[nodiscard]] AlarmOutcome unshelve();
  // Maintenance of its device. Both may be called again.
  void suppress(AlarmPause pause);
  void end_suppression();

  // Forgets occurrences that are too old. True: the status changed.
  bool count(UtcTime now);

  // As it was kept; `occurrences` are the beginnings of the last minutes, in order.
  void restore(const AlarmStatus& kept, std::span<const UtcTime> occurrences, UtcTime now);

 private:
  bool take(IsaInput input);

  IsaState state_ = IsaState::kNormal;
  AlarmStatus status_;
  std::deque<UtcTime> raised_;  // in the window; at most kMaxCounted
};

}  // namespace fieldcast

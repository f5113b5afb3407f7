// Whether one channel keeps its promise: a sample at least once in each refresh. Says when a missed
// refresh is to be told, and counts what was missed as DDS counts deadlines: every refresh that
// passes without a new sample is one.
//
// A small value without I/O, one for each channel. Owned by the ChannelTable, on the bus's thread.
// Nothing can fail. `misses` are the counters of the whole bus: what is counted here is added
// there.
#pragma once

#include <algorithm>
#include <optional>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class Freshness {
 public:
  // from              event                                  to
  // every state       a new sample, another refresh          kInTime
  // kInTime           the refresh runs out, no cause known   kMissed
  // kInTime           the refresh runs out with a cause      kTold
  // every state       a refusal or a lease is told           kTold
  // kMissed           a cause becomes known                  kMissedExplained
  // kMissedExplained  it is told                             kTold
  // kTold, UNCERTAIN  a cause becomes known                  kToldExplained
  // kToldExplained    it is told                             kTold
  enum class State : std::uint8_t {
    kInTime,           // no refresh was missed since the last sample
    kMissed,           // told without a cause; the miss is counted as kLate
    kMissedExplained,  // as kMissed, and the cause is known by now: it is to be told
    kTold,             // the channel's last sample says what is wrong
    kToldExplained,    // told as UNCERTAIN, and a cause is known by now: it is to be told
  };

  // A missed refresh is told so much later than it is missed: a sample that was published in time
  // has reached its DataWriter by then.
  static constexpr Duration kTellAfter = std::chrono::milliseconds{3};

  Freshness() = default;  // no promise
  Freshness(Duration refresh, Duration gap) : refresh_(refresh), gap_(gap) {}

  // Another refresh is in force; nothing: no promise. `gap`: the longest time between two samples
  // that is promised; longer than the refresh where a deadband holds samples back.
  void promise(std::optional<Duration> refresh, Duration gap, Instant now, CauseCounters& misses);
  // The time of the promise begins anew, unless a miss was told already.
  void start(Instant now);
  // A new sample arrived.
  void acquired(Instant at, CauseCounters& misses);
  // The cause that a miss will show.
  void explain(Cause cause) { cause_ = cause; }
  // Reading failed. `uncertain`: the last sample told does not say what is wrong. True when the
  // cause is to be told now: see due().
  [[nodiscard]] bool failing(Cause cause, bool uncertain, Instant now);
  // The refusal of the address was told.
  void refused(Cause cause, Instant now, CauseCounters& misses);
  // The bus is leased. `told`: the channel's last sample was told as UNCERTAIN for it.
  void leased(bool told, Instant now, CauseCounters& misses);
  // REQUIRES: due() <= now. True when the channel's state is to be told.
  [[nodiscard]] bool expire(Instant now, CauseCounters& misses);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool late() const { return state_ != State::kInTime; }
  [[nodiscard]] std::optional<Duration> refresh() const { return refresh_; }
  [[nodiscard]] Cause cause() const { return cause_; }
  // When expire() has something to do; kNever: not before the next call of another function.
  [[nodiscard]] Instant due() const { return due_; }
  // Refreshes missed so far.
  [[nodiscard]] std::uint64_t missed(Instant now) const { return missed_ + passed(now); }
  // Adds the misses that missed() counts and the counters do not hold yet.
  void add_passed(Instant now, CauseCounters& misses) const;
  // The cause of the last miss that was counted.
  [[nodiscard]] Cause last_miss() const { return last_miss_; }

 private:
  [[nodiscard]] Cause blame() const { return cause_ == Cause::kNone ? Cause::kLate : cause_; }
  [[nodiscard]] std::uint64_t passed(Instant now) const;
  void count(std::uint64_t times, CauseCounters& misses);
  void settle(Instant now, CauseCounters& misses);
  void rearm(Instant from);

  State state_ = State::kInTime;
  Cause cause_ = Cause::kNone;
  Cause last_miss_ = Cause::kNone;
  std::optional<Duration> refresh_;
  Duration gap_{};
  Instant promised_ = kNever;  // when the promise breaks
  Instant due_ = kNever;       // when a broken promise is told
  Instant told_ = kLongAgo;    // when late: misses are counted up to then
  std::uint64_t missed_ = 0;
};

}  // namespace fieldcast

// Tracks whether one channel keeps its promise of a sample in each refresh: when to report a miss,
// and how many. Misses are counted as DDS counts deadlines: one per refresh without a new sample.
// One per channel, owned by ChannelTable, on the bus's thread. `misses` are the counters of the
// whole bus, to which each function adds.
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
  // kInTime           the refresh expires without a cause    kMissed
  // kInTime           the refresh expires with a cause       kTold
  // every state       a refusal or a lease is reported       kTold
  // kMissed           a cause becomes known                  kMissedExplained
  // kMissedExplained  it is reported                         kTold
  // kTold, UNCERTAIN  a cause becomes known                  kToldExplained
  // kToldExplained    it is reported                         kTold
  enum class State : std::uint8_t {
    kInTime,           // no miss since the last sample
    kMissed,           // reported without a cause; counted as kLate
    kMissedExplained,  // as kMissed, with a known cause that must be reported
    kTold,             // the channel's last sample shows the problem
    kToldExplained,    // reported as UNCERTAIN; the cause is known and must be reported
  };

  // Delay of a report: a sample published in time has reached its DataWriter by then.
  static constexpr Duration kTellAfter = std::chrono::milliseconds{3};

  Freshness() = default;
  Freshness(Duration refresh, Duration gap) : refresh_(refresh), gap_(gap) {}

  // `refresh`: empty for no promise. `gap`: longest promised time between two samples.
  void promise(std::optional<Duration> refresh, Duration gap, Instant now, CauseCounters& misses);
  // Restarts the time of the promise, unless a miss was already reported.
  void start(Instant now);
  void acquired(Instant at, CauseCounters& misses);
  void explain(Cause cause) { cause_ = cause; }
  // `uncertain`: the last sample does not show the cause. Returns true if it must be reported.
  [[nodiscard]] bool failing(Cause cause, bool uncertain, Instant now);
  void refused(Cause cause, Instant now, CauseCounters& misses);
  // `told`: a sample with UNCERTAIN was published for the lease.
  void leased(bool told, Instant now, CauseCounters& misses);
  // REQUIRES: due() <= now. Returns true if the state must be reported.
  [[nodiscard]] bool expire(Instant now, CauseCounters& misses);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool late() const { return state_ != State::kInTime; }
  [[nodiscard]] std::optional<Duration> refresh() const { return refresh_; }
  [[nodiscard]] Cause cause() const { return cause_; }
  // When to call expire(); kNever: not before a call of another function.
  [[nodiscard]] Instant due() const { return due_; }
  [[nodiscard]] std::uint64_t missed(Instant now) const { return missed_ + passed(now); }
  // Adds the misses that missed() includes and the counters do not.
  void add_passed(Instant now, CauseCounters& misses) const;
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
  Instant promised_ = kNever;
  Instant due_ = kNever;
  Instant told_ = kLongAgo;  // if late: misses are counted up to this time
  std::uint64_t missed_ = 0;
};

}  // namespace fieldcast

#include "core/bus/command/freshness.hpp"

#include "core/base/cause.hpp"

namespace fieldcast {

void Freshness::promise(std::optional<Duration> refresh, Duration gap, Instant now,
                        CauseCounters& misses) {
  settle(now, misses);
  refresh_ = refresh;
  gap_ = gap;
  state_ = State::kInTime;
  rearm(now);
}

void Freshness::start(Instant now) {
  if (!late()) rearm(now);
}

void Freshness::acquired(Instant at, CauseCounters& misses) {
  settle(at, misses);
  state_ = State::kInTime;
  rearm(at);
}

bool Freshness::failing(Cause cause, bool uncertain, Instant now) {
  cause_ = cause;
  if (!late() || !uncertain || quality_of(cause) == Quality::kGood) return false;
  if (state_ == State::kMissed) state_ = State::kMissedExplained;
  if (state_ == State::kTold) state_ = State::kToldExplained;
  due_ = now;
  return true;
}

void Freshness::refused(Cause cause, Instant now, CauseCounters& misses) {
  cause_ = cause;
  settle(now, misses);
  told_ = now;
  state_ = State::kTold;
}

void Freshness::leased(bool told, Instant now, CauseCounters& misses) {
  settle(now, misses);
  cause_ = Cause::kLeased;
  if (!told) return;
  told_ = now;
  state_ = State::kTold;
}

bool Freshness::expire(Instant now, CauseCounters& misses) {
  due_ = kNever;
  switch (state_) {
    case State::kMissed:
    case State::kTold: return false;
    case State::kInTime:
      count(1, misses);
      state_ = cause_ == Cause::kNone ? State::kMissed : State::kTold;
      break;
    case State::kMissedExplained:
      misses.move(Cause::kLate, cause_);
      last_miss_ = cause_;
      count(passed(now), misses);
      state_ = State::kTold;
      break;
    case State::kToldExplained:
      count(passed(now), misses);
      state_ = State::kTold;
      break;
  }
  told_ = now;
  return true;
}

void Freshness::add_passed(Instant now, CauseCounters& misses) const {
  if (late()) misses.add(blame(), passed(now));
}

// Whole gaps since the last reported miss.
std::uint64_t Freshness::passed(Instant now) const {
  if (!late() || !refresh_ || now <= told_) return 0;
  return static_cast<std::uint64_t>((now - told_) / gap_);
}

void Freshness::count(std::uint64_t times, CauseCounters& misses) {
  if (times == 0) return;
  last_miss_ = blame();
  missed_ += times;
  misses.add(last_miss_, times);
}

void Freshness::settle(Instant now, CauseCounters& misses) {
  if (late()) {
    count(passed(now), misses);
    told_ = now;
  } else if (now > promised_) {
    count(1, misses);
  }
}

void Freshness::rearm(Instant from) {
  promised_ = refresh_ ? from + *refresh_ : kNever;
  due_ = refresh_ ? promised_ + std::min(kTellAfter, *refresh_ / 10) : kNever;
}

}  // namespace fieldcast

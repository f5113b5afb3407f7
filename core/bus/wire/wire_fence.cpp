#include "core/bus/wire/wire_fence.hpp"

#include <algorithm>

namespace fieldcast {
namespace {

constexpr std::size_t kShown = 16;  // bytes in the text
// Latency of an adapter, with a margin.
constexpr Duration kBurstGap = std::chrono::milliseconds{20};

// splitmix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014).
std::uint64_t next_random(std::uint64_t& state) {
  std::uint64_t z = state += 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace

WireFence::WireFence(const BusSpec& bus)
    : on_(fence_of(bus.port).is(Fence::kListen)),
      waits_(fence_of(bus.port).is(Fence::kLock) || fence_of(bus.port).is(Fence::kOneClient)),
      times_(fence_times(bus)),
      finder_(bus) {}

void WireFence::set_order(unsigned rank, std::uint64_t seed) {
  rank_ = std::min(rank, kRanks - 1);
  random_ = seed;
}

void WireFence::opened(Instant now) {
  if (waits_) not_before_ = now + times_.quiet;
  if (!on_) return;
  listen_from(now, now);
  strays_.clear();
}

void WireFence::listen_from(Instant silent_since, Instant now) {
  holding_ = false;
  silent_since_ = silent_since;
  not_before_ = kLongAgo;
  noise_since_ = now;
  burst_.clear();
}

// The silence counts, except for the time needed to hear a master that began just now.
void WireFence::lapse(Instant now) {
  listen_from(std::max(busy_until_, last_byte_), now);
  not_before_ = now + times_.hold;
  told_ = false;
}

// Bridges that heard the same byte count the same slots, so ranks never share a slot.
Instant WireFence::slot_from(Instant now) const {
  const Instant first = silent_since_ + times_.listen + rank_ * times_.slot;
  const Instant from = std::max(now - times_.slot / 2, not_before_);
  const Duration round = kRanks * times_.slot;
  const Instant slot =
      from <= first ? first : first + (from - first + round - Duration{1}) / round * round;
  return std::min(slot, noise_since_ + kMostNoise * times_.listen);
}

bool WireFence::may_send(Instant now) {
  if (!on_) return now >= not_before_;
  if (holding_) {
    const bool lost = now - busy_until_ > times_.claim;
    const bool deaf = now - heard_ > kDeaf * times_.listen;
    if (!lost && !deaf) return now >= not_before_;
    cut_off_ = deaf;
    lapse(now);
  }
  return now >= slot_from(now);
}

Instant WireFence::look_again(Instant now) const {
  return holding_ || !on_ ? not_before_ : slot_from(now);
}

bool WireFence::keeps(Instant now) const {
  return !on_ || (holding_ && now - busy_until_ <= times_.claim);
}

bool WireFence::sending(ByteView request, Instant until) {
  if (!on_) return false;
  const bool taken_back = !holding_ && told_;
  if (!holding_) {
    holding_ = true;
    confirmed_ = doubted_ = told_ = false;
    heard_ = until;
    doubtful_ = 0;
  }
  busy_until_ = std::max(busy_until_, until);
  not_before_ = kLongAgo;
  sent_.assign(request.begin(), request.end());
  strays_.clear();
  return taken_back;
}

void WireFence::not_sent(Instant now) {
  if (on_ && holding_) lapse(now);
}

Instant WireFence::sign_due() const {
  if (!on_) return kNever;
  return std::max(holding_ ? busy_until_ + times_.hold : kLongAgo, no_sign_before_);
}

Instant WireFence::sign_from() const {
  if (!on_) return kNever;
  return std::max(holding_ ? busy_until_ + times_.hold * 3 / 4 : kLongAgo, no_sign_before_);
}

void WireFence::bytes_came(bool echo, Instant now) {
  if (!on_) return;
  last_byte_ = now;
  if (!holding_)
    silent_since_ = now;
  else if (!echo)
    heard(now);
}

// After a longer silence the bytes may be from another master.
void WireFence::heard(Instant now) {
  if (!keeps(now)) return listen_from(now, now);
  busy_until_ = heard_ = now;
  cut_off_ = false;
}

// Repetition of the last sent or received frame: a late echo, or a device that repeats itself.
bool WireFence::own(ByteView frame) const {
  return std::ranges::equal(frame, sent_) || std::ranges::equal(frame, response_);
}

bool WireFence::believe(const RequestFinder::Found& found, Instant now) {
  if (found.certain || !holding_) return true;
  if (doubtful_since_ < now - kDoubtFor) {
    doubtful_ = 0;
    doubtful_since_ = now;
  }
  return ++doubtful_ >= kEnoughDoubtful;
}

bool WireFence::take_foreign(ByteView frame, Instant now) {
  listen_from(now, now);
  if (std::exchange(told_, true)) return false;
  ++foreign_masters_;
  text_ =
      "another master speaks on the wire: " + to_hex(frame.first(std::min(frame.size(), kShown)));
  return true;
}

bool WireFence::stray(ByteView bytes, Instant now) {
  if (!on_) return false;
  const bool began = last_stray_ < now - kBurstGap;
  last_stray_ = now;
  if (!holding_) {
    if (began && !burst_.empty()) {
      if (finder_.is_frame(burst_)) noise_since_ = now;
      burst_.clear();
    }
    append(burst_, bytes);
    if (burst_.size() > kKept) burst_.clear();
  }
  if (began) strays_.clear();  // a frame has no such pause
  append(strays_, bytes);
  if (strays_.size() > kKept)
    strays_.erase(strays_.begin(), strays_.end() - static_cast<std::ptrdiff_t>(kKept));
  for (;;) {
    const RequestFinder::Found found = finder_.find(strays_);
    if (found.size == 0) return false;
    const Bytes frame(strays_.begin() + static_cast<std::ptrdiff_t>(found.at),
                      strays_.begin() + static_cast<std::ptrdiff_t>(found.at + found.size));
    strays_.erase(strays_.begin(),
                  strays_.begin() + static_cast<std::ptrdiff_t>(found.at + found.size));
    if (holding_ && own(frame)) continue;
    if (believe(found, now)) return take_foreign(frame, now);
  }
}

bool WireFence::find_foreign(ByteView bytes, Instant now) {
  const RequestFinder::Found found = finder_.find(bytes);
  const ByteView frame = bytes.subspan(found.at, found.size);
  return found.size > 0 && !own(frame) && believe(found, now) && take_foreign(frame, now);
}

bool WireFence::doubts_first(Duration began, Duration character) {
  if (!on_ || !holding_ || confirmed_ || began >= -2 * character) return false;
  return !std::exchange(doubted_, true);
}

bool WireFence::came_between(ByteView bytes, Instant now) {
  return on_ && holding_ && find_foreign(bytes, now);
}

bool WireFence::ended(bool responded, ByteView received, Instant now) {
  if (!on_ || !holding_) return false;
  if (responded) {
    confirmed_ = true;
    response_.assign(received.begin(), received.end());
    return false;
  }
  if (find_foreign(received, now)) return true;
  if (confirmed_) return false;
  // No response yet: another master may have started at the same time.
  const auto drawn = static_cast<unsigned>(next_random(random_) % kRanks);
  if (!received.empty()) rank_ = drawn;
  if (!received.empty() || cut_off_)
    listen_from(std::max(busy_until_, heard_), now);
  else
    not_before_ = now + drawn * times_.slot;
  return false;
}

}  // namespace fieldcast

#include "core/bus/wire/repetition_filter.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {
namespace {

// Number of bytes up to the end of the frame; 0 if they do not contain it.
std::size_t end_of(ByteView frame, ByteView bytes) {
  const auto found = std::search(bytes.begin(), bytes.end(), frame.begin(), frame.end());
  if (found == bytes.end()) return 0;
  return static_cast<std::size_t>(found - bytes.begin()) + frame.size();
}

}  // namespace

void RepetitionFilter::responded(DeviceIndex device, ByteView received, std::size_t expected,
                                 Instant at) {
  device_ = device;
  at_ = at;
  strays_.clear();
  if (watched_[device] > 0) --watched_[device];
  const std::size_t half = received.size() / 2;
  const bool twice = half > 0 && received.size() % 2 == 0 &&
                     std::ranges::equal(received.first(half), received.subspan(half));
  const std::size_t size = twice          ? half
                           : expected > 0 ? std::min(expected, received.size())
                                          : received.size();
  const ByteView frame = received.last(size);
  frame_.assign(frame.begin(), frame.end());
  if (twice) repeated();
  if (std::exchange(discarded_, false)) watched_[device] = kWatched;
}

void RepetitionFilter::stray(ByteView bytes, Instant now) {
  if (frame_.empty() || now > arrived_until()) return;
  if (strays_.size() + bytes.size() > 2 * frame_.size()) return;
  append(strays_, bytes);
  if (end_of(frame_, strays_) > 0) repeated();
}

void RepetitionFilter::repeated() {
  watched_[device_] = kWatched;
  frame_.clear();
}

std::size_t RepetitionFilter::find(ByteView received, Instant asked) const {
  if (frame_.empty() || asked >= arrived_until()) return 0;
  return end_of(frame_, received);
}

}  // namespace fieldcast

#include "core/bus/wire/repetition_filter.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

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
  if (std::ranges::search(strays_, frame_).begin() != strays_.end()) repeated();
}

void RepetitionFilter::repeated() {
  watched_[device_] = kWatched;
  frame_.clear();
}

std::size_t RepetitionFilter::find(ByteView received, Instant asked) const {
  if (frame_.empty() || asked >= arrived_until()) return 0;
  const auto found = std::ranges::search(received, frame_);
  return found.empty() ? 0 : static_cast<std::size_t>(found.end() - received.begin());
}

}  // namespace fieldcast

#include "core/bus/wire/silence_learning.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

SilenceLearning::SilenceLearning(Duration standard, Duration least, std::size_t devices)
    : steps_{standard}, devices_(devices), silent_(devices) {
  while (steps_.back() > least)
    steps_.push_back(std::max(least, std::chrono::duration_cast<Duration>(steps_.back() * kStep)));
  last_ = steps_.size() - 1;
  next_ = std::min<std::size_t>(1, last_);
}

void SilenceLearning::ended(DeviceIndex device, Duration rest, bool responded_now) {
  if (device >= devices_.size()) return;  // ad hoc
  Device& of = devices_[device];
  const bool responded_before = std::exchange(of.responds, responded_now);
  if (responded_before && !responded_now) ++silent_;
  if (!responded_before && responded_now) --silent_;
  // A longer rest says nothing about this step.
  if (step_ > 0 && rest > (steps_[step_ - 1] + steps_[step_]) / 2) return;
  if (responded_now) return responded(of);
  if (responded_before && step_ > 0) failed();
}

void SilenceLearning::responded(Device& device) {
  ++device.responses;
  ++responses_;
  if (step_ == 0) {
    if (wait_ > 0) --wait_;
    if (wait_ == 0 && next_ > 0 && all_accept()) enter(next_);
    return;
  }
  if (!searching_ || !all_accept()) return;
  failures_ = 0;
  next_ = step_ + 1;
  if (step_ < last_) return enter(next_);
  searching_ = false;
  enter(next_ = last_ - 1);
}

void SilenceLearning::failed() {
  const bool is_noise = responses_ >= kProven;
  if (!is_noise && ++failures_ > 1) {
    last_ = step_ - 1;
    // One step longer than the shortest accepted one.
    next_ = last_ > 0 ? last_ - 1 : 0;
    searching_ = false;
    failures_ = 0;
  } else {
    next_ = step_;
  }
  wait_ = kPatience;
  enter(0);
}

void SilenceLearning::enter(std::size_t step) {
  step_ = step;
  responses_ = 0;
  for (Device& device : devices_) device.responses = 0;
}

bool SilenceLearning::all_accept() const {
  return std::ranges::all_of(devices_,
                             [](const Device& device) { return device.responses >= kTries; });
}

}  // namespace fieldcast

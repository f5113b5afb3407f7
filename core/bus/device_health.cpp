#include "core/bus/device_health.hpp"

#include <algorithm>

namespace fieldcast {

bool DeviceHealth::answered() {
  const bool changed = state_ != DeviceState::kOnline;
  state_ = DeviceState::kOnline;
  cause_ = Cause::kNone;
  failures_ = 0;
  probe_interval_ = kFirstProbe;
  probe_at_ = kNever;
  return changed;
}

bool DeviceHealth::failed(Cause cause, Instant now) {
  cause_ = cause;
  if (state_ == DeviceState::kOffline) {
    probe_interval_ = std::min(probe_interval_ * 2, kLastProbe);
    probe_at_ = now + probe_interval_;
    return false;
  }
  const DeviceState before = state_;
  // Broken answers show that somebody is there: only silence takes a device offline.
  if (cause == Cause::kNoAnswer) ++failures_;
  if (failures_ >= kFailuresToOffline) {
    state_ = DeviceState::kOffline;
    probe_at_ = now + probe_interval_;
  } else if (state_ == DeviceState::kOnline ||
             (state_ == DeviceState::kUnknown && cause != Cause::kNoAnswer)) {
    state_ = DeviceState::kDegraded;
  }
  return state_ != before;
}

}  // namespace fieldcast

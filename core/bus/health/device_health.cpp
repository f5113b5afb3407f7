#include "core/bus/health/device_health.hpp"

#include <algorithm>

namespace fieldcast {

bool DeviceHealth::responded() {
  const bool changed = state_ != DeviceState::kOnline;
  state_ = DeviceState::kOnline;
  cause_ = Cause::kNone;
  failures_ = 0;
  busy_since_ = kNever;
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
  // Only silence, or busy responses for a long time, take a device offline: a broken response shows
  // that it is present.
  if (cause == Cause::kNoResponse) ++failures_;
  bool busy_too_long = false;
  if (cause == Cause::kDeviceBusy) {
    if (busy_since_ == kNever) {
      busy_since_ = now;
      return false;
    }
    busy_too_long = now - busy_since_ >= kBusyToOffline;
  }
  if (failures_ >= kFailuresToOffline || busy_too_long) {
    state_ = DeviceState::kOffline;
    probe_at_ = now + probe_interval_;
  } else if (state_ == DeviceState::kOnline ||
             (state_ == DeviceState::kUnknown && cause != Cause::kNoResponse)) {
    state_ = DeviceState::kDegraded;
  }
  return state_ != before;
}

}  // namespace fieldcast

#include "core/bus/health/device_health.hpp"

#include <algorithm>

namespace fieldcast {

bool DeviceHealth::responded() {
  const bool changed = state_ != DeviceState::kOnline;
  state_ = DeviceState::kOnline;
  cause_ = Cause::kNone;
  connection_lost_ = false;
  failures_ = 0;
  busy_since_ = kNever;
  probe_interval_ = kFirstProbe;
  probe_at_ = kNever;
  return changed;
}

bool DeviceHealth::failed(Cause cause, Instant now, bool connection_lost) {
  cause_ = cause;
  connection_lost_ = connection_lost;
  if (state_ == DeviceState::kOffline) {
    probe_interval_ = std::min(probe_interval_ * 2, kLastProbe);
    probe_at_ = now + probe_interval_;
    return false;
  }
  const DeviceState before = state_;
  // Silence, exchanges that cost the connection, or busy responses for a long time take a device
  // offline. Another broken response only shows that it is present.
  if (cause == Cause::kNoResponse || connection_lost) ++failures_;
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

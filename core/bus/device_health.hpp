// Whether a device is there: online, degraded, offline; and when a silent one is asked again.
// Pure value, one for each device, owned by the DeviceMonitor, on the bus's thread. Nothing can
// fail.
#pragma once

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class DeviceHealth {
 public:
  // This many exchanges in a row without an answer, retries included in each, take a device
  // offline.
  static constexpr unsigned kFailuresToOffline = 2;
  // So do answers that it cannot at the moment (Cause::kDeviceBusy), with no other answer between,
  // after this time. One of them changes no state.
  static constexpr Duration kBusyToOffline = std::chrono::seconds{10};
  static constexpr Duration kFirstProbe = std::chrono::milliseconds{500};
  static constexpr Duration kLastProbe = std::chrono::seconds{30};

  // Each returns true when the state changed.
  bool answered();                        // any valid answer, a refusal too
  bool failed(Cause cause, Instant now);  // an exchange with all its retries

  [[nodiscard]] DeviceState state() const { return state_; }
  [[nodiscard]] bool offline() const { return state_ == DeviceState::kOffline; }
  [[nodiscard]] Cause cause() const { return cause_; }  // of the last failure; kNone when online
  [[nodiscard]] Instant probe_at() const { return probe_at_; }  // when offline
  void probe_from(Instant until) { probe_at_ = until; }

 private:
  DeviceState state_ = DeviceState::kUnknown;
  Cause cause_ = Cause::kNone;
  unsigned failures_ = 0;
  Instant busy_since_ = kNever;
  Duration probe_interval_ = kFirstProbe;
  Instant probe_at_ = kNever;
};

}  // namespace fieldcast

// Availability of a device (online, degraded, offline) and the next probe of an offline one. Pure
// value, one per device, owned by DeviceMonitor, on the bus's thread.
#pragma once

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class DeviceHealth {
 public:
  // Consecutive exchanges without a response, each including its retries, or that cost the
  // connection.
  static constexpr unsigned kFailuresToOffline = 2;
  // Time of only Cause::kDeviceBusy responses; a single one changes no state.
  static constexpr Duration kBusyToOffline = std::chrono::seconds{10};
  static constexpr Duration kFirstProbe = std::chrono::milliseconds{500};
  static constexpr Duration kLastProbe = std::chrono::seconds{30};

  // Each returns true if the state changed.
  bool responded();  // any valid response, including a refusal
  // `connection_lost`: the failure cost the connection to all devices.
  bool failed(Cause cause, Instant now, bool connection_lost = false);

  [[nodiscard]] DeviceState state() const { return state_; }
  [[nodiscard]] bool offline() const { return state_ == DeviceState::kOffline; }
  [[nodiscard]] Cause cause() const { return cause_; }  // of the last failure; kNone if online
  // The last failure cost the connection; false if online.
  [[nodiscard]] bool connection_lost() const { return connection_lost_; }
  [[nodiscard]] Instant probe_at() const { return probe_at_; }  // only valid when offline
  void probe_from(Instant until) { probe_at_ = until; }

 private:
  DeviceState state_ = DeviceState::kUnknown;
  Cause cause_ = Cause::kNone;
  bool connection_lost_ = false;
  unsigned failures_ = 0;
  Instant busy_since_ = kNever;
  Duration probe_interval_ = kFirstProbe;
  Instant probe_at_ = kNever;
};

}  // namespace fieldcast

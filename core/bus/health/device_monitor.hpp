// The devices of one bus: availability, response times, pauses, probes, counters and broken
// responses. Owned by the bus engine, on the bus's thread. An offline device is not read but probed
// at growing intervals. An unhealthy device, whose responses are often lost or broken, is deferred
// after each failure until the wire has spare time.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/bus/health/device_health.hpp"
#include "core/bus/health/garbage.hpp"
#include "core/bus/health/learning.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class DeviceMonitor {
 public:
  static constexpr Duration kBusyPause = std::chrono::milliseconds{100};
  static constexpr Duration kShortestProbe = std::chrono::milliseconds{10};
  static constexpr Duration kProbeRetry = std::chrono::milliseconds{20};
  // How long a probe waits for spare time for the whole timeout, before it uses a shorter one.
  static constexpr Duration kProbePatience = std::chrono::seconds{1};
  // An unhealthy device wastes at most this fraction (1/N) of the wire time.
  static constexpr int kSickShare = 10;

  struct Try {
    DeviceIndex device = 0;
    Cause cause = Cause::kNone;  // kNone if it succeeded
    Duration rest{};             // between the device's last response and the request
    Instant responded{};
    ByteView received, sent;
    bool echo_alone = false;   // only the echo arrived; `received` does not contain it
    std::size_t expected = 0;  // characters of the whole response; 0 if unknown
  };
  // `timeout`: the time that can be spared.
  struct Probe {
    DeviceIndex device = 0;
    Request request;
    Duration timeout{};
  };
  using Slack = std::function<Duration()>;
  // Earliest time for a request with respect to pending responses.
  using Gate = std::function<Instant(DeviceIndex, const Request&)>;

  // `probed`: by device, the range read as a probe; empty if the device is never probed.
  DeviceMonitor(const BusSetup& setup, std::vector<std::optional<Range>> probed);

  [[nodiscard]] Instant paused_until(DeviceIndex device) const {
    return devices_[device].paused_until;
  }
  [[nodiscard]] Duration rest_before(DeviceIndex device, Instant now) const;
  // The learned timeout applies only to reads whose late responses identify their request.
  // `whole`: the configured one.
  [[nodiscard]] Duration timeout(DeviceIndex device, const Request& request, bool whole) const;
  void asked(DeviceIndex device) { ++devices_[device].report.exchanges; }
  void not_asked(DeviceIndex device) { --devices_[device].report.exchanges; }

  // Call after each try, before it is repeated.
  void tried(const Try& ended, Instant now, ActionSink& sink);
  void repeated(DeviceIndex device) { ++devices_[device].report.retries; }

  // Result of a gateway's read; kNone if the device responded. A read without a response is no
  // sign of the device's health, as some devices ignore unknown addresses; the next read of the
  // gateway is expected to last as long. Call instead of tried() after such a failure.
  void gateway_read_ended(DeviceIndex device, Cause cause, Instant now);
  // Time on the wire with the silence after it; with a timeout if the device may not respond.
  [[nodiscard]] Duration longest_exchange(DeviceIndex device, const Request& request) const;
  // Another ad-hoc device has the index now: discards learned values.
  void replaced(DeviceIndex device) { devices_[device] = unknown_device(device); }

  // A valid response or a refusal, but not Cause::kDeviceBusy.
  void responded(DeviceIndex device, ActionSink& sink);
  void learn(DeviceIndex device, const Request& request, Duration response_time);
  void inherit(DeviceIndex device, const DeviceReport& learned);
  void learn_late(DeviceIndex device, Duration response_time);
  void busy(DeviceIndex device, Instant now);
  // True after two such responses; a single one may concern its block only.
  [[nodiscard]] bool stays_busy(DeviceIndex device) const { return devices_[device].busy(); }
  // No response, or kDeviceBusy. Returns true if the device went offline; discards learned values.
  // `connection_lost`: see DeviceHealth.
  [[nodiscard]] bool failed(DeviceIndex device, Cause cause, Instant now, ActionSink& sink,
                            bool connection_lost = false);

  // `wasted`: wire time of the failure.
  void defer_if_sick(DeviceIndex device, Duration wasted, Instant now);
  // Appends the devices whose deferral ends. Returns when to check again.
  [[nodiscard]] Instant admit_deferred(Instant now, const Slack& slack,
                                       std::vector<DeviceIndex>& admitted);
  // Time until which the scheduler must not poll the device; empty if unchanged.
  [[nodiscard]] std::optional<Instant> suspension(DeviceIndex device, Instant now);

  [[nodiscard]] std::optional<Probe> probe(Instant now, const Gate& gate, const Slack& slack);
  [[nodiscard]] Instant next_probe() const;
  // A short read of the online device with the fastest response, unhealthy devices last.
  [[nodiscard]] std::optional<Probe> sign(Instant now, const Gate& gate) const;
  void opened(Instant now);

  [[nodiscard]] bool offline(DeviceIndex device) const { return devices_[device].health.offline(); }
  [[nodiscard]] bool all_offline() const;
  [[nodiscard]] bool responded_since_opened() const { return responded_since_opened_; }
  [[nodiscard]] bool sick(DeviceIndex device) const { return devices_[device].sick(); }
  [[nodiscard]] Duration longest_response(DeviceIndex device) const {
    return devices_[device].response_time.longest();
  }
  // See ResponseTime.
  [[nodiscard]] Duration usual_response(DeviceIndex device, Duration margin) const {
    return devices_[device].response_time.usual(margin);
  }
  [[nodiscard]] std::optional<Duration> earliest_response(DeviceIndex device) const;
  // `began`: after the end of the request, usually negative here.
  [[nodiscard]] bool too_early(DeviceIndex device, Duration began) const;
  // The caller adds the parts about channels and blocks.
  [[nodiscard]] DeviceReport report(DeviceIndex device) const;

 private:
  struct Device {
    explicit Device(const ResponseTime& unknown) : response_time(unknown) {}
    DeviceHealth health;
    ResponseTime response_time;
    std::vector<ResponseTime> area_times;
    PauseLearning pauses;
    Garbage garbage;
    Instant responded_at = kLongAgo;
    Instant paused_until = kLongAgo;
    double failure_share = 0;           // of the last tries, 0..1
    unsigned busy_in_a_row = 0;         // consecutive Cause::kDeviceBusy responses
    Instant deferred_until = kLongAgo;  // at the latest; kLongAgo if not deferred
    Duration wasted{};
    bool gateway_read_failed = false;     // the last one
    Instant probe_not_before = kLongAgo;  // set when the wire had no time for a probe
    bool suspended = false;               // last value reported to the scheduler
    DeviceReport report;

    [[nodiscard]] bool busy() const { return busy_in_a_row > 1; }
    [[nodiscard]] bool sick() const { return failure_share > 0.2; }
    void forget();
  };
  [[nodiscard]] Device unknown_device(DeviceIndex device) const;
  void judge_garbage(const Try& ended, bool responded, ActionSink& sink);
  [[nodiscard]] Instant next_probe_of(DeviceIndex device) const;
  [[nodiscard]] std::optional<Duration> probe_timeout(DeviceIndex device, const Request& request,
                                                      Instant now, const Slack& slack) const;

  const BusSetup& setup_;
  std::vector<std::optional<Range>> probed_;
  std::vector<Device> devices_;  // behind the configured ones, the ad-hoc devices
  bool anybody_responded_ = false;
  bool responded_since_opened_ = false;
};

}  // namespace fieldcast

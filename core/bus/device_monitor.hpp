// The devices of one bus: whether each is there, how long it takes to answer, when it may be asked
// again, and what it sends in place of answers.
//
// Owns health, answer times, pauses, probes and counters of every device. Owned by the bus engine,
// on the bus's thread. Nothing can fail; changes that people should know of become notices.
//
// An offline device is not read; it is probed ever more rarely. A sick device, whose answers are
// often lost or broken, is deferred after each failure until the wire has time to waste.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/bus/action_sink.hpp"
#include "core/bus/answer_time.hpp"
#include "core/bus/bus_setup.hpp"
#include "core/bus/device_health.hpp"
#include "core/bus/garbage.hpp"
#include "core/bus/pause_learning.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class DeviceMonitor {
 public:
  static constexpr Duration kBusyPause = std::chrono::milliseconds{100};  // after "busy"
  static constexpr Duration kShortestProbe = std::chrono::milliseconds{10};
  // Until the next look, when the wire had no time for a probe.
  static constexpr Duration kProbeRetry = std::chrono::milliseconds{20};
  // A probe waits so long for a moment in which the wire can spare the whole timeout, before a
  // shorter one is tried.
  static constexpr Duration kProbePatience = std::chrono::seconds{1};
  // A sick device wastes at most one part in this many of the wire's time.
  static constexpr int kSickShare = 10;

  // One try of an exchange.
  struct Try {
    DeviceIndex device = 0;
    Cause cause = Cause::kNone;  // kNone: done
    Duration rest{};             // between the device's last answer and the request
    Instant answered{};          // when done: arrival of the answer
    ByteView received, sent;     // the last ones
    bool echo_alone = false;     // nothing came but what was sent, which `received` has not
    std::size_t expected = 0;    // characters of the whole answer; 0: not known
  };
  // A read that shows whether an offline device is back. `timeout`: what can be spared.
  struct Probe {
    DeviceIndex device = 0;
    Request request;
    Duration timeout{};
  };
  // How long the wire may be blocked now without making a read late.
  using Slack = std::function<Duration()>;
  // From when on a request to a device may be sent, as far as late answers are concerned.
  using Gate = std::function<Instant(DeviceIndex, const Request&)>;

  // `probed`: the range that is read as a probe, of each device; nothing: never probed.
  DeviceMonitor(const BusSetup& setup, std::vector<std::optional<Range>> probed);

  // Before a request.
  [[nodiscard]] Instant paused_until(DeviceIndex device) const {
    return devices_[device].paused_until;
  }
  [[nodiscard]] Duration rest_before(DeviceIndex device, Instant now) const;
  // What was learned shortens the wait only for reads that can be asked again, and whose late
  // answers show whose they are: the bus goes on meanwhile, and they still count.
  [[nodiscard]] Duration timeout(DeviceIndex device, const Request& request, bool command) const;
  void asked(DeviceIndex device) { ++devices_[device].report.exchanges; }
  // The request did not leave.
  void not_asked(DeviceIndex device) { --devices_[device].report.exchanges; }

  // After each try, and before it is repeated.
  void tried(const Try& ended, Instant now, ActionSink& sink);
  void repeated(DeviceIndex device) { ++devices_[device].report.retries; }

  // After an exchange: any valid answer, a refusal too, but not Cause::kDeviceBusy.
  void answered(DeviceIndex device, ActionSink& sink);
  void learn(DeviceIndex device, const Request& request, Duration answer_time);
  // What another bridge has learned.
  void inherit(DeviceIndex device, const DeviceReport& learned);
  // An answer came after it had been given up.
  void learn_late(DeviceIndex device, Duration answer_time);
  // Leaves the device alone for kBusyPause.
  void busy(DeviceIndex device, Instant now);
  // Its last answers were Cause::kDeviceBusy, at least two. One alone may concern its block.
  [[nodiscard]] bool stays_busy(DeviceIndex device) const { return devices_[device].busy(); }
  // After an exchange without an answer, or with Cause::kDeviceBusy. True: the device went offline,
  // and another one may be there when it comes back; what was learned of it is forgotten.
  [[nodiscard]] bool failed(DeviceIndex device, Cause cause, Instant now, ActionSink& sink);

  // Leaves a sick device alone for a while: its failure wasted this much of the wire's time.
  void defer_if_sick(DeviceIndex device, Duration wasted, Instant now);
  // Ends the deferrals whose time has come, or whose next failure the wire can afford: those
  // devices are appended. Returns when to look again.
  [[nodiscard]] Instant admit_deferred(Instant now, const Slack& slack,
                                       std::vector<DeviceIndex>& admitted);
  // Until when the scheduler must leave the device alone from now on; nothing: as it was told last.
  [[nodiscard]] std::optional<Instant> suspension(DeviceIndex device, Instant now);

  // The probe that is due now, if the wire has time for one.
  [[nodiscard]] std::optional<Probe> probe(Instant now, const Gate& gate, const Slack& slack);
  [[nodiscard]] Instant next_probe() const;
  // A short read of a device that answers, of those that may be asked now the one with the quickest
  // answer, a sick one last; `timeout`: what it takes, mostly.
  [[nodiscard]] std::optional<Probe> sign(Instant now, const Gate& gate) const;
  // The port was opened: a device that did not answer before may do so now.
  void opened(Instant now);

  [[nodiscard]] bool offline(DeviceIndex device) const { return devices_[device].health.offline(); }
  [[nodiscard]] bool all_offline() const;
  [[nodiscard]] bool sick(DeviceIndex device) const { return devices_[device].sick(); }
  // The longest time that it took for one of its last answers.
  [[nodiscard]] Duration longest_answer(DeviceIndex device) const {
    return devices_[device].answer_time.longest();
  }
  // An answer that began at this time after the end of its request (mostly below zero) is not one
  // of this device.
  [[nodiscard]] bool too_early(DeviceIndex device, Duration began) const;
  // All but what its channels and blocks say.
  [[nodiscard]] DeviceReport report(DeviceIndex device) const;

 private:
  struct Device {
    explicit Device(const AnswerTime& unknown) : answer_time(unknown) {}
    DeviceHealth health;
    AnswerTime answer_time;
    std::vector<AnswerTime> area_times;  // areas of one device answer in times of their own
    PauseLearning pauses;
    Garbage garbage;
    Instant answered_at = kLongAgo;       // its last answer
    Instant paused_until = kLongAgo;      // it wants a rest
    double failure_share = 0;             // of its last tries, 0..1
    unsigned busy_in_a_row = 0;           // answers with Cause::kDeviceBusy, and no other between
    Instant deferred_until = kLongAgo;    // at the latest; kLongAgo: not deferred
    Duration wasted{};                    // wire time of its last failure
    Instant probe_not_before = kLongAgo;  // the wire had no time for a probe
    bool suspended = false;               // as the scheduler was told last
    DeviceReport report;                  // its counters

    [[nodiscard]] bool busy() const { return busy_in_a_row > 1; }
    [[nodiscard]] bool sick() const { return failure_share > 0.2; }
    void forget();
  };
  void judge_garbage(const Try& ended, bool answered, ActionSink& sink);
  [[nodiscard]] Instant next_probe_of(DeviceIndex device) const;
  [[nodiscard]] std::optional<Duration> probe_timeout(DeviceIndex device, const Request& request,
                                                      Instant now, const Slack& slack) const;

  const BusSetup& setup_;
  std::vector<std::optional<Range>> probed_;
  std::vector<Device> devices_;
  bool anybody_answered_ = false;  // ever, on this line
};

}  // namespace fieldcast

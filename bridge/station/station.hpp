// A monitoring station or plant system: the other side of DdsLink, for our tools, tests and
// benches.
//
// Owns its DDS participant. Channels and samples come by blocks, on a thread of the station's own;
// everything else, and samples that are asked for with a deadline, comes on DDS threads. Callbacks
// come one at a time for each subscription and must not block. Subscribe before using what arrives;
// the object may be used from any one thread. No DDS type appears here.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/dds/dds_error.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

enum class StationFault : std::uint8_t {
  kNoBridge,  // no bridge that serves the bus was found within the wait: it was not sent
  kNoResult,  // the command was written and no result came within its lifespan and the wait
  kNotSent,   // it does not fit the topic: a name or a list is too long
  kNotAPath,  // the channel is not named as BUS/DEVICE/CHANNEL
  kNoSite,    // of several sites, the bus names none
  kNoPerson,  // the person's name has other characters than those of a user, or too many
  kNoRight,   // the identity of this station, by DDS Security, is none that commands
};
[[nodiscard]] std::string_view to_text(StationFault fault);

// What became of a command: its one result, or why there is none.
using StationOutcome = tl::expected<StationResult, StationFault>;
// "verified", "rejected: channel is read-only (READ_ONLY)", "no result came in time".
[[nodiscard]] std::string to_text(const StationOutcome& outcome);

// True if the result proves that the command was not run, as the bus was stopped or taken over by
// another bridge at that moment: it may be sent again, under a new request_id.
[[nodiscard]] bool was_not_run(const StationResult& result);

// How old a value is by this machine's clock, against the instant at which the bridge had the last
// byte of it. Needs clocks that agree. A channel that was never read is as old as the epoch.
[[nodiscard]] Duration age(const StationSample& sample);

class Station {
 public:
  // Joins the domain; `name` is how other tools see the participant. Throws DdsError.
  Station(const DdsSpec& spec, const std::string& name);
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  // Each may be called once. `gone` is called when an instance was disposed or its bridge is gone
  // (samples, channels).
  using OnSample = std::function<void(const StationSample&)>;
  using OnGone = std::function<void(const std::string& bus, const std::string& device,
                                    const std::string& channel)>;
  using OnMissed = OnGone;
  struct SampleOptions {
    // Matches just the channels that promise this refresh or better.
    std::optional<Duration> deadline;
    // No sample of the channel came for `deadline`. Called again for each further one that passes.
    OnMissed on_deadline_missed;
    // Each sample by itself (fieldcast/Sample) instead of by blocks; so it is with a deadline too.
    bool one_by_one = false;
  };
  void subscribe_samples(OnSample on_sample, OnGone gone, SampleOptions options);
  void subscribe_samples(OnSample on_sample, OnGone gone = {}) {
    subscribe_samples(std::move(on_sample), std::move(gone), {});
  }
  // What came by blocks so far. Any thread.
  struct BlockCounters {
    std::uint64_t blocks = 0;
    std::uint64_t missing = 0;   // blocks that never came: this station was too slow for them
    std::uint64_t requests = 0;  // for the last values, where blocks were missing
  };
  [[nodiscard]] BlockCounters block_counters() const;
  void subscribe_channels(std::function<void(const StationChannel&)> on_channel, OnGone gone = {});
  void subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                            std::function<void(const StationBusStatus& last)> gone = {});
  void subscribe_device_status(std::function<void(const StationDeviceStatus&)> on_status,
                               std::function<void(const StationDeviceStatus& last)> gone = {});
  // The bridges of the domain. One that ends without a word is gone when its lease is over.
  void subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                         std::function<void(const StationBridge& last)> gone = {});
  void subscribe_program_sessions(std::function<void(const ProgramSessionReport&)> on_session);
  // The whole plan, whenever another one is in force.
  void subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                            std::function<void(const std::string& bus)> gone = {});
  void subscribe_alarms(std::function<void(const StationAlarm&)> on_alarm,
                        std::function<void(const StationAlarm& last)> gone = {});
  // What people did about alarms, beside the alarms themselves: acknowledged, shelved, suppressed.
  void subscribe_alarm_status(std::function<void(const StationAlarmStatus&)> on_status,
                              std::function<void(const StationAlarmStatus& last)> gone = {});

  // By DDS Security, what this station may do besides reading. Without it, everything.
  [[nodiscard]] bool may_command() const;
  [[nodiscard]] bool may_declare_interest() const;

  // An interest in channels at a refresh, kept up until withdrawn or until this process dies.
  // Throws DdsError unless may_declare_interest().
  void declare_interest(const std::string& pattern, Duration refresh);
  void withdraw_interest(const std::string& pattern);

  // Writes the command once the bridge that serves the bus is found (at most wait_for_bridge) and
  // blocks for its one result, at most lifespan + wait_for_result. A command that was_not_run() is
  // sent again while its lifespan lasts, here and in send(); the caller sees one command with one
  // request_id and one result. request_id and requester are set here. kNoRight: as all below.
  [[nodiscard]] StationOutcome execute(StationCommand command,
                                       Duration wait_for_bridge = std::chrono::seconds{3},
                                       Duration wait_for_result = std::chrono::seconds{5});

  // Writes one value to a channel, "BUS/DEVICE/CHANNEL", as execute() does. The bridge checks the
  // value against the channel's type and range.
  [[nodiscard]] StationOutcome write(std::string_view path, Value value, bool verify = false);

  // Does not wait for the result: gives the request_id (on_result, set before the first call, is
  // called with the result on a thread of the station or of DDS).
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(
      StationCommand command, Duration wait_for_bridge = std::chrono::seconds{3});
  void on_result(std::function<void(const StationResult&)> handler);
  // A request_id that a command or an action may have when it is sent later, once: so that whoever
  // waits for its result can be noted before it is sent.
  [[nodiscard]] std::uint64_t reserve_request_id();

  // The same for what a person does about an alarm: acknowledge it, shelve it, put its device into
  // maintenance. It has one result too, kDone or kRejected, and ids of the same count. requester
  // and request_id of the action are filled in here.
  [[nodiscard]] StationOutcome execute(AlarmAction action,
                                       Duration wait_for_bridge = std::chrono::seconds{3},
                                       Duration wait_for_result = std::chrono::seconds{5});
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(
      AlarmAction action, Duration wait_for_bridge = std::chrono::seconds{3});

  // The discovery servers of the configuration that do not answer. Any thread.
  [[nodiscard]] std::vector<std::string> missing_servers() const;

  // Unique for each process and object. The requester of a person's command is made of it:
  // ".../anna".
  [[nodiscard]] const std::string& requester() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast

// A monitoring station or plant system: the other side of DdsLink, for our tools and tests. It
// watches one domain or several sites: then the name of the site precedes its bridges and buses
// ("north:line-7"), and commands, actions and interests are sent to the site that their bus names.
//
// Owns a DDS participant for each site. Callbacks run on threads of the sites or of DDS, one at a
// time for each subscription, and must not block. Subscribe before you use received data, from any
// one thread. No DDS type appears here.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <typeinfo>
#include <utility>
#include <vector>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/history_values.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "core/base/time.hpp"
#include "core/model/dds_spec.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

enum class StationFault : std::uint8_t {
  kNoBridge,  // no bridge that serves the bus was found within the wait: the command was not sent
  kNoResult,  // the command was written, but no result arrived within its lifespan and the wait
  kNotSent,   // it does not fit the topic: a name or a list is too long
  kNotAPath,  // the channel is not named as BUS/DEVICE/CHANNEL
  kNoSite,    // of several sites, the bus names none
  kNoPerson,  // the user's name is too long or contains characters that are not allowed
  kNotTaken,  // DDS did not take it, as bridges do not acknowledge earlier ones
  kNoRight,   // the DDS Security identity of this station may not send commands
};
[[nodiscard]] std::string_view to_text(StationFault fault);

// The result of a command, or the reason why there is none.
using StationOutcome = tl::expected<StationResult, StationFault>;
// "verified", "rejected: channel is read-only (READ_ONLY)", "no result came in time".
[[nodiscard]] std::string to_text(const StationOutcome& outcome);

// True if the result proves that the command was not run, because the bus was stopped or taken over
// by another bridge at that moment. It may then be sent again, under a new request_id.
[[nodiscard]] bool was_not_run(const StationResult& result);

// Age by this machine's clock since the bridge received the value. Needs synchronized clocks.
[[nodiscard]] Duration age(const StationSample& sample);

// The pattern that applies at a site of this name: "north:*/m/t" is "*/m/t" at "north", "*" is "*"
// at every site, "north:line-7" gives `std::nullopt` at "south".
[[nodiscard]] std::optional<std::string> pattern_at_site(std::string_view pattern,
                                                         std::string_view site);

class Station {
 public:
  // Joins the domains of all sites; other tools show `name`. Throws DdsError with the site.
  // Without a site it joins none. REQUIRES: unique names, not empty unless there is only one site.
  Station(const std::vector<DdsSite>& sites, const std::string& name);
  // Joins one domain, whose buses keep their names.
  Station(const DdsSpec& spec, const std::string& name);
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  // Call each at most once. `gone` is called when an instance was disposed or its bridge has
  // disconnected (samples, channels).
  using OnSample = std::function<void(const StationSample&)>;
  using OnGone = std::function<void(const std::string& bus, const std::string& device,
                                    const std::string& channel)>;
  using OnMissed = OnGone;
  struct SampleOptions {
    // Matches only the channels that promise this refresh or a shorter one.
    std::optional<Duration> deadline;
    // No sample of the channel arrived within `deadline`. Called again for each further deadline
    // that passes, also while another callback runs.
    OnMissed on_deadline_missed;
    // Receives single samples (fieldcast/Sample) instead of blocks; a deadline implies it.
    bool one_by_one = false;
  };
  void subscribe_samples(OnSample on_sample, OnGone gone, const SampleOptions& options);
  void subscribe_samples(OnSample on_sample, OnGone gone = {}) {
    subscribe_samples(std::move(on_sample), std::move(gone), {});
  }
  // Counters of received blocks, of all sites. Any thread.
  struct BlockCounters {
    std::uint64_t blocks = 0;
    std::uint64_t missing = 0;   // lost blocks: this station was too slow for them
    std::uint64_t requests = 0;  // for the last values, after blocks were lost
  };
  [[nodiscard]] BlockCounters block_counters() const;
  void subscribe_channels(std::function<void(const StationChannel&)> on_channel, OnGone gone = {});
  void subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                            std::function<void(const StationBusStatus& last)> gone = {});
  // Receives the values of a Report (bridge/dds/topics/topics.hpp).
  template <class Value>
  void subscribe(std::function<void(const Value&)> on_value,
                 std::function<void(const Value& last)> gone = {}) {
    subscribe(typeid(Value), any_value(std::move(on_value)), any_value(std::move(gone)));
  }
  void subscribe_device_status(std::function<void(const StationDeviceStatus&)> on_status,
                               std::function<void(const StationDeviceStatus& last)> gone = {}) {
    subscribe(std::move(on_status), std::move(gone));
  }
  // The bridges of the domain. A bridge that crashes is reported as removed when its lease expires.
  void subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                         std::function<void(const StationBridge& last)> gone = {});
  // Reports the whole plan whenever a new plan is in force.
  void subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                            const std::function<void(const std::string& bus)>& gone = {});
  // Interests of all stations in the domain. Reports nothing with DDS Security, where no station
  // has the right to read them.
  void subscribe_interests(std::function<void(const Interest&)> on_interest,
                           std::function<void(const Interest& last)> gone);
  void subscribe_alarms(std::function<void(const StationAlarm&)> on_alarm,
                        std::function<void(const StationAlarm& last)> gone = {}) {
    subscribe(std::move(on_alarm), std::move(gone));
  }
  // Actions of users on alarms: acknowledged, shelved, suppressed.
  void subscribe_alarm_status(std::function<void(const StationAlarmStatus&)> on_status,
                              std::function<void(const StationAlarmStatus& last)> gone = {}) {
    subscribe(std::move(on_status), std::move(gone));
  }

  // Rights by DDS Security in addition to reading, at one site at least; all without DDS Security.
  [[nodiscard]] bool may_command() const;
  [[nodiscard]] bool may_declare_interest() const;

  // Declares an interest until it is withdrawn or this process ends, at every site that matches and
  // permits it. Throws DdsError if the only site does not.
  void declare_interest(const std::string& pattern, Duration refresh);
  void withdraw_interest(const std::string& pattern);

  // Writes the command once the bridge of the bus is found (at most wait_for_bridge) and blocks for
  // its one result, at most lifespan + wait_for_result. A command that was_not_run() is sent again
  // within its lifespan. Sets request_id and requester. Fails with kNoRight and kNoSite, as all
  // below.
  [[nodiscard]] StationOutcome execute(StationCommand command,
                                       Duration wait_for_bridge = std::chrono::seconds{3},
                                       Duration wait_for_result = std::chrono::seconds{5});

  // Writes one value to "BUS/DEVICE/CHANNEL", as execute(). The bridge checks type and range.
  [[nodiscard]] StationOutcome write(std::string_view path, Value value, bool verify = false);

  // Does not wait for the result; returns the request_id. The result is passed to the handler of
  // on_result(), which must be set before the first call, on a thread of the station or of DDS.
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(
      StationCommand command, Duration wait_for_bridge = std::chrono::seconds{3});
  void on_result(std::function<void(const StationResult&)> handler);
  // Reserves a request_id, so that the caller can register for its result before it is sent.
  [[nodiscard]] std::uint64_t reserve_request_id();

  // The same for an operator's action on an alarm, with one result, kDone or kRejected, and ids of
  // the same sequence. Sets requester and request_id.
  [[nodiscard]] StationOutcome execute(AlarmAction action,
                                       Duration wait_for_bridge = std::chrono::seconds{3},
                                       Duration wait_for_result = std::chrono::seconds{5});
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(
      AlarmAction action, Duration wait_for_bridge = std::chrono::seconds{3});

  // Requests stored samples of a bus from the store of the bridge that serves it, and blocks for
  // the response, at most `wait`. Sets requester and request_id. Continue with a further request
  // after the last row of the response, as long as `complete` is smaller than the number of
  // channels. Fails with kNoBridge, kNoResult, kNoRight and kNoSite; then the request may be
  // repeated. One thread at a time.
  [[nodiscard]] tl::expected<HistoryResponse, StationFault> history(
      HistoryRequest request, Duration wait = std::chrono::seconds{2});
  // Reason of kNoRight from history(), and what to do.
  static constexpr std::string_view kNoHistoryRight =
      "this identity has no right to fieldcast/HistoryRequest and HistoryBlock: goes on without "
      "missing samples; 'fieldcast secure renew' gives an identity of an earlier version this "
      "right";
  // Ends the reception of stored samples until the next request. The thread of history().
  void end_history();

  // Sends a request about the configuration of a bridge, JSON text, and blocks for its reply, at
  // most `wait`. Fails with kNoBridge, kNoResult, kNoRight, kNoSite and kNotSent. One thread at a
  // time.
  [[nodiscard]] tl::expected<std::string, StationFault> configuration(const std::string& bridge,
                                                                      std::string request,
                                                                      Duration wait);
  // Ends a pending configuration() and refuses later ones. Any thread.
  void cancel_configuration();

  // The configured discovery servers of all sites that do not respond, each once. Any thread.
  [[nodiscard]] std::vector<std::string> missing_servers() const;

  // Unique for each process and object; for a user's command: ".../anna".
  [[nodiscard]] const std::string& requester() const;

 private:
  using OnAny = std::function<void(const void* value)>;
  template <class Value>
  static OnAny any_value(std::function<void(const Value&)> handler) {
    if (!handler) return {};
    return [inner = std::move(handler)](const void* value) {
      inner(*static_cast<const Value*>(value));
    };
  }
  void subscribe(const std::type_info& type, OnAny on_value, OnAny gone);

  struct Site;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast

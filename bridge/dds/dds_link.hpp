// The bridge's side of DDS: publishes catalogue, samples, results and status of its buses, and
// receives commands and interests.
//
// Owns every DDS entity of the process. Handlers are called on DDS threads, must not block, and
// only post. No DDS type appears here.
//
// Threads. "One caller for a bus" means: any thread, one call at a time for each bus. In the daemon
// that is the bus's own thread while nothing of the bus waits, else the publisher thread
// (bridge/publish/dds_publisher.hpp). Functions of different buses may run at the same time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/dds/dds_error.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/utc_mapping.hpp"
#include "bridge/standby/bus_claims.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/alarm/alarm_status.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"
#include "core/plan/plan_report.hpp"

namespace fieldcast {

class Domain;

class DdsLink {
 public:
  // Other bridges of the domain, by an identity that no two share. On DDS threads.
  struct BridgeHandlers {
    std::function<void(const std::string& id)> found;  // it has said nothing yet
    std::function<void(const std::string& id, BridgeClaims claims)> received;
    std::function<void(const std::string& id, bool alive)> alive;  // by its lease
    std::function<void(const std::string& id)> lost;
  };
  struct Handlers {
    std::function<UtcMapping()> clock;  // reads both clocks now; any thread
    // A command for a bus that was added. `expires` is its source timestamp plus the writer's
    // LIFESPAN on the engine's clock and may have passed already: the engine answers kExpired.
    // Commands for other buses never come here.
    std::function<void(const std::string& bus, Command command)> on_command;
    std::function<void(Interest interest)> on_interest;
    // For the log: incompatible QoS, a limit reached, a malformed command.
    std::function<void(std::string text)> on_problem;
    BridgeHandlers bridges{};  // all of them or none
    // What a person does about an alarm of a bus that was added. It is answered by complete().
    // Null: nobody listens.
    std::function<void(AlarmAction action)> on_alarm_action{};
    // Readers of samples have come, or a station asks for the last values. Null: nobody listens.
    std::function<void()> on_readers{};
    // A command that has expired when it arrives, and the reason, with the clocks of both. Null:
    // on_command() is called.
    std::function<void(const std::string& bus, Command command, std::string why)> on_late_command{};
  };

  struct BusCounters {
    std::uint64_t deadline_misses = 0;  // offered deadlines missed, over all channels of the bus
    std::uint32_t sample_readers = 0;   // readers matched by the bus's busiest Sample writer
    std::uint32_t sample_writers = 0;   // that have channels
    std::uint64_t blocks = 0;           // written to SampleBlock, with those of snapshots
    std::uint32_t block_readers = 0;    // matched by the bus's SampleBlock writer
  };

  // Joins the domain. Throws DdsError: an interface that does not exist, a profile that cannot be
  // loaded.
  DdsLink(const DdsSpec& spec, const std::string& bridge_name, Handlers handlers);
  ~DdsLink();  // close()
  DdsLink(const DdsLink&) = delete;
  DdsLink& operator=(const DdsLink&) = delete;

  // The folder of the bridge's identity has a renewed certificate, which a new link would take. Any
  // thread.
  [[nodiscard]] bool has_new_identity() const;

  // Publishes the catalogue of the bus and makes its Sample writers: one for each distinct refresh,
  // none with more than 256 channels. Its commands arrive from here on: listen_for_commands(). One
  // thread at a time. Throws DdsError. REQUIRES: no bus of this name.
  void add_bus(const BusSpec& bus);
  // For a bus that another bridge of the standby group serves: its writers are made and find their
  // readers, and commands for it arrive, but nothing is written. add_bus() is to follow, or
  // take_over_bus(). Like add_bus().
  void prepare_bus(const BusSpec& bus);
  // As add_bus(), for a bus that another bridge has served until now: samples and blocks go on
  // where that one was. The catalogue is written by publish_again(), which may wait.
  void take_over_bus(const BusSpec& bus, const FollowedBus& followed);
  // While another bridge of the group serves the buses, malformed commands are its business.
  void stand_by(bool standing_by);
  // Of each bus that was added.
  [[nodiscard]] std::vector<StandbyBusFigures> stream_figures() const;
  // For endpoints of the standby group, which end before the link does.
  [[nodiscard]] Domain& domain();
  // Plant systems find this bridge from here on. For a bridge whose buses are all served by others:
  // commands that are written when it takes one over must not be lost, as they would be before
  // discovery. A second call has no effect. One thread at a time. Throws DdsError.
  void listen_for_commands();

  // This bridge among the others: its identity, and what it tells them. REQUIRES: handlers for
  // them. One thread at a time.
  [[nodiscard]] std::string id() const;
  void announce(const BridgeClaims& claims);
  // Writes again what is written only once: another bridge that served the bus as well has disposed
  // of it. One thread at a time.
  void publish_again(std::string_view bus);

  // Disposes every instance of the bus in all topics, so that stations see it go, and waits at most
  // `linger` until the readers of its samples have received that. `limit`: of the disposal, for a
  // participant that leaves the domain anyway, which ends the instances that are left. Like
  // add_bus(). REQUIRES: nobody publishes on it any more (its thread has ended). No effect for an
  // unknown bus.
  void remove_bus(std::string_view bus, Duration linger = std::chrono::milliseconds{100},
                  Duration limit = Duration::max());

  // The samples of an exchange: as a block for stations that take blocks, then each for all others.
  // Samples of one channel leave in order; channels out of range are a bug. One caller for a bus,
  // who waits as long as DDS takes for them: some 10 us each, longer with readers that lag.
  void publish(std::string_view bus, std::span<const Sample> samples, const UtcMapping& mapping);
  // The two parts of it. Both have one caller for a bus, which need not be the same one: a block
  // costs some 10 us, however many samples it has. True: somebody reads samples one by one, so that
  // publish_each() is to follow.
  [[nodiscard]] bool publish_block(std::string_view bus, std::span<const Sample> samples,
                                   const UtcMapping& mapping);
  void publish_each(std::string_view bus, std::span<const Sample> samples,
                    const UtcMapping& mapping);

  // Moves a channel to the writer of another refresh: its last sample is written there again, then
  // the old writer lets go of it. Nothing: no promise (on-demand). Republishes the catalogue entry.
  // One caller for a bus.
  void set_refresh(std::string_view bus, ChannelIndex channel, std::optional<Duration> refresh);

  // Publishes the one result of a command and releases its instance. Any thread. A result whose
  // requester's reader is not matched yet is held for up to a second.
  void complete(std::string_view bus, const CommandResult& result, const UtcMapping& mapping);

  // Status, once a second and at changes. One caller for a bus.
  void report(std::string_view bus, const BusReport& report, UtcTime at);
  void report(std::string_view bus, std::string_view device, const DeviceReport& report,
              UtcTime at);
  // Another plan is in force. One caller for a bus.
  void report(std::string_view bus, const PlanReport& plan, UtcTime since);

  // A programming session: it began, its bytes grew, it ended. Any thread. One instance for each
  // device; no more of them than devices of a bridge.
  void report(const ProgramSessionReport& session);
  // An alarm was raised or is clear. Its instance stays, active or clear, until the bus is removed.
  // One caller for a bus.
  void report(std::string_view bus, const AlarmChange& change, const UtcMapping& mapping);

  // What is known of an alarm. No effect for an unknown bus; as an alarm, until the bus is removed.
  // One caller for a bus.
  void report(const AlarmKey& alarm, const AlarmStatus& status);
  // The alarm is none any more: its limit is taken away. One caller for its bus.
  void forget(const AlarmKey& alarm);

  [[nodiscard]] BusCounters counters(std::string_view bus) const;  // any thread
  // The discovery servers of the configuration that do not answer. Any thread.
  [[nodiscard]] std::vector<std::string> missing_servers() const;
  // Bridges that were found and have shown no writer yet. Any thread.
  [[nodiscard]] std::size_t unknown_bridges() const;

  enum class Leave : std::uint8_t {
    kDispose,   // stations see the buses go
    kHandOver,  // another bridge serves them by now
  };
  // Removes every bus, waits up to `linger` until readers have the last results, leaves the domain.
  // Handlers are not called after it returns. Main thread; a second call has no effect.
  void close(Duration linger = std::chrono::milliseconds{200}, Leave leave = Leave::kDispose);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast

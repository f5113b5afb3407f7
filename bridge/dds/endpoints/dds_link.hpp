// The bridge's side of DDS: publishes catalogue, samples, results and status of its buses, and
// receives commands and interests. Owns every DDS entity of the process. Handlers are called on DDS
// threads, must not block, and only post. No DDS type appears here.
//
// Threads. "One caller for a bus" means: any thread, one call at a time for each bus, the bus's own
// thread or the publisher thread (bridge/publish/bus_output.hpp). Functions of different buses may
// run at the same time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/configuration_message.hpp"
#include "bridge/dds/topics/history_values.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/standby/bus_claims.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/alarm/alarm_status.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/dds_spec.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"
#include "core/plan/read_plan.hpp"

namespace fieldcast {

class Domain;

// Returns true if every peer is on this machine. Ignores transports of the user's profile.
[[nodiscard]] bool stays_on_this_machine(const DdsSpec& spec);

class DdsLink {
 public:
  // Notifications about other bridges, each with a unique id. Called on DDS threads.
  struct BridgeHandlers {
    std::function<void(const std::string& id)> found;  // before its first announcement
    std::function<void(const std::string& id, BridgeClaims claims)> received;
    // its lease expired or is valid again
    std::function<void(const std::string& id, bool alive)> alive;
    std::function<void(const std::string& id)> lost;
  };
  struct Handlers {
    std::function<UtcMapping()> clock;  // reads both clocks now; called on any thread
    // A command for an added bus. `expires`: source timestamp plus the writer's LIFESPAN on the
    // engine's clock. `late`: why it has expired on arrival; empty if it has not.
    std::function<void(const std::string& bus, Command command, std::string late)> on_command;
    std::function<void(Interest interest)> on_interest;
    // A text for the log: incompatible QoS, a limit reached, a malformed command.
    std::function<void(std::string text)> on_problem;
    BridgeHandlers bridges{};  // set all of them or none
    // An operator's action on an alarm of an added bus; complete() responds. Null: not received.
    std::function<void(AlarmAction action)> on_alarm_action{};
    // A request for stored samples of any bus; respond() responds. `fault`: why it breaks the
    // rules, or empty. Null: not received.
    std::function<void(HistoryRequest request, std::string fault)> on_history{};
    // A request about the configuration of this bridge; respond() responds. `subject`: of the
    // requester, by DDS Security. `fault`: why it must be refused, or empty. Null: not received.
    std::function<void(ConfigurationMessage request, std::string subject, std::string fault)>
        on_configuration{};
    // A `Command` or `AlarmAction` that is refused without a call of the handlers above: it is
    // malformed, or was written before this bridge listened. `asked` has its requester, subject,
    // device and target. May be null.
    std::function<void(const std::string& bus, const Command& asked, const CommandResult& result)>
        on_rejected{};
    // Called when readers of samples match or a station requests the last values. May be null.
    std::function<void()> on_readers{};
  };

  struct BusCounters {
    std::uint64_t deadline_misses = 0;  // offered deadlines missed, over all channels of the bus
    std::uint32_t sample_readers = 0;   // readers matched by the bus's busiest Sample writer
    std::uint32_t sample_writers = 0;   // Sample writers that have channels
    std::uint64_t blocks = 0;           // blocks written to SampleBlock, including snapshots
    std::uint64_t waited = 0;           // of them: waited for those of other buses, see BurstRule
    std::uint32_t block_readers = 0;    // readers matched by the bus's SampleBlock writer
  };

  // Joins the domain. Throws DdsError, for example for an unknown interface or profile.
  DdsLink(const DdsSpec& spec, const std::string& bridge_name, Handlers handlers);
  ~DdsLink();  // calls close()
  DdsLink(const DdsLink&) = delete;
  DdsLink& operator=(const DdsLink&) = delete;

  // Returns true if a new link would use a renewed certificate. Any thread.
  [[nodiscard]] bool has_new_identity() const;

  // Publishes the catalogue of the bus and creates its Sample writers. Its commands arrive from now
  // on (listen_for_commands()). One thread at a time. Throws DdsError. REQUIRES: no bus of this
  // name.
  void add_bus(const BusSpec& bus);
  // Prepares a bus that another bridge of the group serves: creates its writers and receives
  // commands, but writes no data. add_bus() or take_over_bus() must follow. Threads as for
  // add_bus().
  void prepare_bus(const BusSpec& bus);
  // Like add_bus(), but sample numbers and blocks continue where another bridge stopped.
  // publish_again() writes the catalogue, and may be called later.
  void take_over_bus(const BusSpec& bus, const FollowedBus& followed);
  // While another bridge serves the buses, this one does not reject malformed commands.
  void stand_by(bool standing_by);
  [[nodiscard]] std::vector<StandbyBusFigures> stream_figures() const;
  // For endpoints of the standby group, which must be removed before the link is destroyed.
  [[nodiscard]] Domain& domain();
  // Makes this bridge discoverable by plant systems, if other bridges serve all its buses: commands
  // written at a takeover are not lost then. Idempotent. One thread at a time. Throws DdsError.
  void listen_for_commands();

  // Identity of this bridge, and its announcement. REQUIRES: `Handlers::bridges`. One thread.
  [[nodiscard]] std::string id() const;
  void announce(const BridgeClaims& claims);
  // Waits at most `limit` until bridges and stations have received the last announcement.
  void wait_for_announcement(Duration limit);
  // Writes again what another bridge that also served the bus has disposed. One thread at a time.
  void publish_again(std::string_view bus);

  // Disposes every instance of the bus, so that stations see its end, and waits at most `linger`
  // each for the readers of its samples, of catalogue blocks and of its channels. `limit` bounds
  // the disposal. Threads as for add_bus(). Requests for the bus still arrive, so that a restart
  // of the bus loses none. ignore_requests() ends that.
  // REQUIRES: no thread publishes on the bus any more. No effect for an unknown bus.
  void remove_bus(std::string_view bus, Duration linger = std::chrono::milliseconds{100},
                  Duration limit = Duration::max());
  // Requests for the bus are for another bridge, or for none. Threads as for add_bus().
  void ignore_requests(const std::string& bus);

  // Publishes the samples of an exchange: as a block, then one by one for readers of Sample, in
  // order for each channel. A channel out of range is a bug. One caller for a bus; some 10 us a
  // sample.
  void publish(std::string_view bus, std::span<const Sample> samples, const UtcMapping& mapping);
  // The two parts of publish(); their callers may differ. A block costs some 10 us. publish_block()
  // returns true if readers of Sample are matched, so that publish_each() must follow.
  [[nodiscard]] bool publish_block(std::string_view bus, std::span<const Sample> samples,
                                   const UtcMapping& mapping);
  void publish_each(std::string_view bus, std::span<const Sample> samples,
                    const UtcMapping& mapping);

  // Moves a channel to the writer of another refresh (`std::nullopt`: no promise), writes its last
  // sample again there, and republishes the catalogue entry. One caller for a bus.
  void set_refresh(std::string_view bus, ChannelIndex channel, std::optional<Duration> refresh);

  // Publishes the result of a command and releases its instance. Any thread. A result whose
  // requester's reader is not matched yet is held for up to a second.
  void complete(std::string_view bus, const CommandResult& result, const UtcMapping& mapping);

  // Responds to a request for stored samples. One thread at a time; waits between blocks.
  void respond(const HistoryRequest& request, const HistoryResponse& response);
  // The same for a request about the configuration.
  void respond(const ConfigurationMessage& reply);
  // Returns the quality of the last sample of each channel of a bus, by channel index; empty if
  // this bridge does not serve the bus. Any thread.
  [[nodiscard]] std::vector<Quality> qualities(const BusSpec& bus) const;
  // Epoch of the catalogue of a bus that this bridge serves; 0 if it does not. Any thread.
  [[nodiscard]] std::uint64_t epoch_of(std::string_view bus) const;

  // Publishes status, once a second and at changes. One caller for a bus.
  void report(std::string_view bus, const BusReport& report, UtcTime at);
  void report(std::string_view bus, std::string_view device, const DeviceReport& report,
              UtcTime at);
  // Publishes the plan that is now in force. One caller for a bus.
  void report(std::string_view bus, const PlanReport& plan, UtcTime since);

  // Publishes the value of a Report (topics.hpp) that belongs to no bus of the link. Any thread.
  // The topic limits the number of instances.
  template <class Value>
  void report(const Value& value) {
    report(typeid(value), &value);
  }
  // Publishes that an alarm was raised or cleared, until the bus is removed. One caller for a bus.
  void report(std::string_view bus, const AlarmChange& change, const UtcMapping& mapping);

  // Publishes the status of an alarm, until the bus is removed. One caller for a bus.
  void report(const AlarmKey& alarm, const AlarmStatus& status);
  // Disposes an alarm whose limit was removed. One caller for its bus.
  void forget(const AlarmKey& alarm);

  [[nodiscard]] BusCounters counters(std::string_view bus) const;  // any thread
  // The configured discovery servers that do not respond. Any thread.
  [[nodiscard]] std::vector<std::string> missing_servers() const;
  // Number of bridges that were found but have not shown a writer yet. Any thread.
  [[nodiscard]] std::size_t unknown_bridges() const;

  enum class Leave : std::uint8_t {
    kDispose,   // stations see the end of the buses
    kHandOver,  // another bridge serves the buses now
  };
  // Removes every bus, waits up to `linger` until readers have the last results, and leaves the
  // domain. Handlers are not called after it returns. Main thread; a second call has no effect.
  void close(Duration linger = std::chrono::milliseconds{200}, Leave leave = Leave::kDispose);

 private:
  struct State;
  void report(const std::type_info& type, const void* value);
  struct State2;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast

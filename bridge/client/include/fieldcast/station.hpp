/// @file
/// A station: a program that watches the channels of Fieldcast bridges in one DDS domain or in
/// several, and sends commands to them.
///
/// @code
/// fieldcast::api::Station station("my-station");
/// auto values = station.subscribe("line/*", [](const fieldcast::api::Sample& sample) { ... });
/// fieldcast::api::Result result = station.write("line/meter/setpoint", 42.0);
/// @endcode
///
/// Threads. Any thread may use a Station. Handlers run on threads of the library, one at a time for
/// each subscription, and must not block: a handler that blocks delays the other handlers. A
/// handler may use the Station, except for its blocking functions (write, acquire, acknowledge).
///
/// Lifetime. A subscription ends when its Subscription is destroyed. The destructor returns after a
/// running handler of the subscription has returned, unless the handler itself destroys it. A
/// Subscription must not outlive its Station.
///
/// Exceptions. Constructors throw JoinError. A function that begins a subscription throws JoinError
/// if DDS refuses it, and std::invalid_argument for a pattern that is not valid. A handler must not
/// throw: the program is terminated. Other functions throw only std::bad_alloc.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fieldcast/alarms.hpp"
#include "fieldcast/commands.hpp"
#include "fieldcast/settings.hpp"
#include "fieldcast/status.hpp"
#include "fieldcast/values.hpp"

namespace fieldcast::api {
inline namespace v1 {

/// Ends what Station::subscribe() and its relatives began when it is destroyed. Movable. A default
/// one is empty.
class Subscription {
 public:
  Subscription() = default;
  Subscription(Subscription&& other) noexcept : end_(std::exchange(other.end_, nullptr)) {}
  Subscription& operator=(Subscription&& other) noexcept;
  ~Subscription() { end(); }
  void end();  ///< now instead of at the destruction
  [[nodiscard]] explicit operator bool() const { return end_ != nullptr; }

  /// For the library: `end` is called once.
  explicit Subscription(std::function<void()> end) : end_(std::move(end)) {}

 private:
  std::function<void()> end_;
};

struct SampleOptions {
  /// Receives only channels that promise this refresh or a shorter one. 0: all.
  Duration refresh{};
  /// With a refresh: called for each refresh of a channel in which no sample arrived.
  std::function<void(const Path&)> on_missed;
  /// Called when a channel is no longer served: its bridge has left, or the channel was removed.
  std::function<void(const Path&)> on_removed;
};

class Station {
 public:
  /// Joins one domain. `name` is the name of this program in the tools of others.
  explicit Station(const std::string& name, const Domain& domain = {});
  /// Joins several domains; each needs a name of its own. Patterns and paths begin with it:
  /// "north:line-7/*".
  Station(const std::string& name, const std::vector<Domain>& domains);
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  /// A pattern is BUS/DEVICE/CHANNEL with `*` for any characters; "line" means "line/*/*". A
  /// pattern that is not valid throws std::invalid_argument with the reason. Each subscription
  /// begins with the last values known, so that the order of calls does not matter.
  [[nodiscard]] Subscription subscribe(std::string_view pattern,
                                       std::function<void(const Sample&)> on_sample,
                                       SampleOptions options = {});
  [[nodiscard]] Subscription catalogue(std::string_view pattern,
                                       std::function<void(const Channel&)> on_channel,
                                       std::function<void(const Path&)> on_removed = {});
  [[nodiscard]] Subscription alarms(std::string_view pattern,
                                    const std::function<void(const Alarm&)>& on_alarm);
  [[nodiscard]] Subscription bus_status(const std::function<void(const BusStatus&)>& on_status);
  [[nodiscard]] Subscription device_status(
      const std::function<void(const DeviceStatus&)>& on_status);
  [[nodiscard]] Subscription bridges(const std::function<void(const Bridge&)>& on_bridge);
  /// The whole read plan of each bus, again whenever a new plan is in force.
  [[nodiscard]] Subscription read_plans(const std::function<void(const ReadPlan&)>& on_plan);
  /// The last session of each device.
  [[nodiscard]] Subscription programming_sessions(
      const std::function<void(const ProgrammingSession&)>& on_session);

  /// Requests the channels with `acquire: on-interest` at this refresh while the Subscription
  /// exists. Other channels keep their refresh. Empty if this station, by DDS Security, may not
  /// declare interests.
  [[nodiscard]] Subscription interest(std::string_view pattern, Duration refresh);

  /// Writes one value to the channel BUS/DEVICE/CHANNEL and blocks for the result. The bridge
  /// checks type and range. A command that was not run since another bridge took over the bus is
  /// sent again within its lifespan.
  [[nodiscard]] Result write(std::string_view path, Value value,
                             const CommandOptions& options = {});
  /// Reads the channel now, or all channels of BUS/DEVICE, and blocks for the result; the values
  /// are published as samples too.
  [[nodiscard]] Result acquire(std::string_view path, const CommandOptions& options = {});
  /// Writes consecutive values from an address of the device BUS/DEVICE on, and blocks for the
  /// result.
  [[nodiscard]] Result write(std::string_view device, const Address& address,
                             std::vector<Value> values, const CommandOptions& options = {});
  /// Reads `count` consecutive values, at most 2048, from an address of the device BUS/DEVICE on,
  /// and blocks for the result.
  [[nodiscard]] Result acquire(std::string_view device, const Address& address,
                               std::uint32_t count = 1, const CommandOptions& options = {});
  /// Acknowledges the present occurrence of an alarm and blocks for the result.
  [[nodiscard]] Result acknowledge(const Alarm& alarm, const std::string& person,
                                   const std::string& note = {});

  /// Blocks that were lost since this station was too slow, over all domains; the library requests
  /// the last values again by itself.
  [[nodiscard]] std::uint64_t lost_blocks() const;
  /// Discovery servers of the configuration that do not respond.
  [[nodiscard]] std::vector<std::string> missing_servers() const;

  struct State;  ///< private to the library

 private:
  std::unique_ptr<State> state_;
};

}  // namespace v1
}  // namespace fieldcast::api

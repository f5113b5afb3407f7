// Watches several sites: one Station for each, with the site's name before the names of bridges and
// buses ("north:line-7"). It has the functions of a Station of one domain for all sites; commands,
// actions and interests are sent to the site that their bus names. With one site without a name it
// behaves like a Station.
//
// Owns its stations. Callbacks arrive as those of Station do: one at a time for each subscription,
// for all sites together. Subscribe before you use received data.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

// The pattern that applies at a site of this name: "north:*/m/t" is "*/m/t" at "north", "*" is "*"
// at every site, "north:line-7" gives `std::nullopt` at "south".
[[nodiscard]] std::optional<std::string> pattern_at_site(std::string_view pattern,
                                                         std::string_view site);

class Sites {
 public:
  // Joins all domains; `name` is the participant name that other tools see. Throws DdsError, which
  // names the site. REQUIRES: names are unique, and none is empty unless there is only one site.
  Sites(const std::vector<DdsSite>& sites, const std::string& name);
  ~Sites();
  Sites(const Sites&) = delete;
  Sites& operator=(const Sites&) = delete;

  // As those of Station; call each once.
  void subscribe_samples(Station::OnSample on_sample, Station::OnGone gone = {});
  void subscribe_channels(std::function<void(const StationChannel&)> on_channel,
                          Station::OnGone gone = {});
  template <class Value>
  void subscribe(std::function<void(const Value&)> on_value,
                 std::function<void(const Value& last)> gone = {}) {
    share_turn(on_value, gone);
    for (const Site& site : sites_)
      site.station->subscribe(at_site(site, on_value), at_site(site, gone));
  }
  void subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                            std::function<void(const StationBusStatus& last)> gone = {});
  void subscribe_device_status(std::function<void(const StationDeviceStatus&)> on_status,
                               std::function<void(const StationDeviceStatus& last)> gone = {}) {
    subscribe(std::move(on_status), std::move(gone));
  }
  void subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                         std::function<void(const StationBridge& last)> gone = {});
  void subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                            std::function<void(const std::string& bus)> gone = {});
  void subscribe_alarms(std::function<void(const StationAlarm&)> on_alarm,
                        std::function<void(const StationAlarm& last)> gone = {}) {
    subscribe(std::move(on_alarm), std::move(gone));
  }
  void subscribe_alarm_status(std::function<void(const StationAlarmStatus&)> on_status,
                              std::function<void(const StationAlarmStatus& last)> gone = {}) {
    subscribe(std::move(on_status), std::move(gone));
  }
  [[nodiscard]] Station::BlockCounters block_counters() const;

  // True if it is possible at one site at least.
  [[nodiscard]] bool may_declare_interest() const;
  // Declares the interest at every site that the pattern may match and where this program may
  // declare one.
  void declare_interest(const std::string& pattern, Duration refresh);
  void withdraw_interest(const std::string& pattern);

  // As those of Station; kNoSite if the bus names none of the sites.
  [[nodiscard]] StationOutcome execute(StationCommand command,
                                       Duration wait_for_bridge = std::chrono::seconds{3},
                                       Duration wait_for_result = std::chrono::seconds{5});
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(
      StationCommand command, Duration wait_for_bridge = std::chrono::seconds{3});
  [[nodiscard]] StationOutcome execute(AlarmAction action,
                                       Duration wait_for_bridge = std::chrono::seconds{3},
                                       Duration wait_for_result = std::chrono::seconds{5});
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(
      AlarmAction action, Duration wait_for_bridge = std::chrono::seconds{3});
  [[nodiscard]] StationOutcome write(std::string_view path, Value value, bool verify = false);
  // Results of all sites. An id is unique across sites.
  void on_result(std::function<void(const StationResult&)> handler);
  [[nodiscard]] std::uint64_t reserve_request_id();

  // Of all sites, each once.
  [[nodiscard]] std::vector<std::string> missing_servers() const;

 private:
  struct Site {
    std::string name;    // empty: the only one
    std::string prefix;  // "north:"; empty: none
    std::unique_ptr<Station> station;
  };
  // Returns the site that a bus names, and removes the prefix from the name. Null if there is none.
  [[nodiscard]] Station* take_site(std::string& bus);
  // Adds the prefix of a site to the names in a value.
  template <class Value>
  static void add_prefix(Value& value, const std::string& prefix) {
    if constexpr (requires { value.bus; }) value.bus.insert(0, prefix);
    if constexpr (requires { value.bridge; }) value.bridge.insert(0, prefix);
    if constexpr (requires { value.alarm.bus; }) value.alarm.bus.insert(0, prefix);
    if constexpr (requires { value.buses; }) {
      for (auto& each : value.buses) each.bus.insert(0, prefix);
    }
  }
  static void add_prefix(std::string& bus, const std::string& prefix) { bus.insert(0, prefix); }
  // Makes the handler of one site from a handler of all sites.
  template <class Value>
  static std::function<void(const Value&)> at_site(
      const Site& site, const std::function<void(const Value&)>& handler) {
    if (!handler || site.prefix.empty()) return handler;
    return [handler, prefix = site.prefix](const Value& value) {
      Value named = value;
      add_prefix(named, prefix);
      handler(named);
    };
  }
  // Makes a handler and its `gone` handler run one at a time across sites.
  template <class Handler, class Gone>
  void share_turn(Handler& handler, Gone& gone) const {
    if (sites_.size() == 1) return;
    const auto mutex = std::make_shared<std::mutex>();
    handler = [mutex, inner = std::move(handler)](const auto& message) {
      const std::lock_guard lock(*mutex);
      inner(message);
    };
    if (!gone) return;
    gone = [mutex, inner = std::move(gone)](const auto&... message) {
      const std::lock_guard lock(*mutex);
      inner(message...);
    };
  }
  // Calls `subscribe` for every site.
  template <class Value, class Subscribe>
  void subscribe_all(std::function<void(const Value&)> handler,
                     std::function<void(const Value&)> gone, Subscribe subscribe) {
    share_turn(handler, gone);
    for (const Site& site : sites_)
      subscribe(*site.station, at_site(site, handler), at_site(site, gone));
  }

  std::vector<Site> sites_;
  std::mutex reserving_;
};

}  // namespace fieldcast

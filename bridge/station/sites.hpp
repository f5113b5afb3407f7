// Several sites watched at once: a Station for each, told apart by the site's name before the names
// of bridges and buses ("north:line-7"). What a Station of one domain gives, this gives for all of
// them; commands, actions and interests go to the site that their bus names. One site without a
// name is just a Station.
//
// Owns its stations. Callbacks come as those of Station do: one at a time for each subscription,
// whichever site they are of. Subscribe before using what arrives.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// The pattern as it is at a site of this name: "north:*/m/t" is "*/m/t" at "north", "*" is "*" at
// every site, "north:line-7" is none at "south".
[[nodiscard]] std::optional<std::string> pattern_at_site(std::string_view pattern,
                                                         std::string_view site);

class Sites {
 public:
  // Joins all domains; `name` is how other tools see the participants. Throws DdsError, which names
  // the site. REQUIRES: names are unique, and none is empty unless there is one site alone.
  Sites(const std::vector<DdsSite>& sites, const std::string& name);
  ~Sites();
  Sites(const Sites&) = delete;
  Sites& operator=(const Sites&) = delete;

  // As those of Station, each once.
  void subscribe_samples(Station::OnSample on_sample, Station::OnGone gone = {});
  void subscribe_channels(std::function<void(const StationChannel&)> on_channel,
                          Station::OnGone gone = {});
  void subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                            std::function<void(const StationBusStatus& last)> gone = {});
  void subscribe_device_status(std::function<void(const StationDeviceStatus&)> on_status,
                               std::function<void(const StationDeviceStatus& last)> gone = {});
  void subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                         std::function<void(const StationBridge& last)> gone = {});
  void subscribe_program_sessions(std::function<void(const ProgramSessionReport&)> on_session);
  void subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                            std::function<void(const std::string& bus)> gone = {});
  void subscribe_alarms(std::function<void(const StationAlarm&)> on_alarm,
                        std::function<void(const StationAlarm& last)> gone = {});
  void subscribe_alarm_status(std::function<void(const StationAlarmStatus&)> on_status,
                              std::function<void(const StationAlarmStatus& last)> gone = {});
  [[nodiscard]] Station::BlockCounters block_counters() const;  // of all sites

  // At one site at least.
  [[nodiscard]] bool may_declare_interest() const;
  // An interest at every site that the pattern may match and where this program may declare one.
  void declare_interest(const std::string& pattern, Duration refresh);
  void withdraw_interest(const std::string& pattern);

  // As those of Station; kNoSite when the bus names none of the sites.
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
  // Results of all sites. An id is of one command, whatever site it went to.
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
  // The site that a bus names; the prefix is taken off the name. Null: none.
  [[nodiscard]] Station* take_site(std::string& bus);
  // A handler of all sites, made one of a site: `name(message, prefix)` puts the prefix in.
  template <class Message, class Name>
  auto at_site(const Site& site, const std::function<void(const Message&)>& handler, Name name);
  // The same for every site: subscribe(station, handler, gone).
  template <class Message, class Name, class Subscribe>
  void subscribe_all(std::function<void(const Message&)> handler,
                     std::function<void(const Message&)> gone, Name name, Subscribe subscribe);

  std::vector<Site> sites_;
  std::mutex reserving_;
};

}  // namespace fieldcast

// The participant of a Station at one site, with its endpoints. Any thread, except where stated.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/block_subscription.hpp"
#include "bridge/station/bus_table.hpp"
#include "bridge/station/clock_offsets.hpp"
#include "bridge/station/command_client.hpp"
#include "bridge/station/request_client.hpp"
#include "bridge/station/station.hpp"
#include "bridge/station/subscription.hpp"

namespace fieldcast {

inline constexpr char kAfterSite = ':';  // not allowed in names of sites and buses

struct Station::Site {
  Site(const DdsSite& site, StationIdentity& identity)
      : name(site.name),
        prefix(name.empty() ? "" : name + kAfterSite),
        station(identity),
        domain(site.dds, station.name, nullptr) {}

  [[nodiscard]] bool may_write(const char* topic) const {
    const auto& member = domain.member();
    const security::TopicRight* right = security::right_of(topic);
    return !member || (right != nullptr && right->writers.has(member->role));
  }
  [[nodiscard]] bool may_command() const { return may_write(kCommandTopic.name); }
  [[nodiscard]] bool may_declare_interest() const { return may_write(kInterestTopic.name); }

  // Created at the first command: a read-only station has no writers.
  CommandClient& client() {
    const std::lock_guard lock(mutex);
    if (!commands) commands = std::make_unique<CommandClient>(domain, station);
    return *commands;
  }
  BlockSubscription& by_blocks() {
    const std::lock_guard lock(mutex);
    if (!blocks) blocks = std::make_unique<BlockSubscription>(domain, station.short_name);
    return *blocks;
  }
  HistoryClient& stored() {
    const std::lock_guard lock(mutex);
    if (!history) history = std::make_unique<HistoryClient>(domain, station.requester);
    return *history;
  }
  ConfigurationClient& configuration() {
    const std::lock_guard lock(mutex);
    if (!configurations)
      configurations = std::make_unique<ConfigurationClient>(domain, station.requester);
    return *configurations;
  }
  template <class Generated, class Type = TopicType<Generated>>
  void subscribe(const Topic<Generated>& topic, const dds::DataReaderQos& qos,
                 typename Subscription<Generated, Type>::Handlers handlers) {
    auto made =
        std::make_shared<Subscription<Generated, Type>>(domain, topic, qos, std::move(handlers));
    const std::lock_guard lock(mutex);
    FIELDCAST_CHECK(subscriptions.emplace(topic.name, std::move(made)).second);
  }
  // Without a refresh: withdraws the interest. Several patterns of the station may be one here:
  // "*" and "north:*".
  void write_interest(const std::string& of_station, const std::string& pattern,
                      std::optional<Duration> refresh) {
    if (interests == nullptr && refresh)
      interests = domain.writer(kInterestTopic, station.short_name);
    if (interests == nullptr) return;
    std::map<std::string, Duration>& declared = declared_interests[pattern];
    if (refresh)
      declared.insert_or_assign(of_station, *refresh);
    else
      declared.erase(of_station);
    idl::Interest interest;
    // Stations of one name have interests of their own: the key contains the process.
    interest.station() = station.requester;
    interest.pattern() = pattern;
    if (declared.empty()) {
      declared_interests.erase(pattern);
      interests->unregister_instance(&interest, dds::HANDLE_NIL);  // disposes it
      return;
    }
    const auto shortest =
        std::ranges::min_element(declared, {}, [](const auto& each) { return each.second; });
    interest.refresh(shortest->second.count());
    interests->write(&interest);
  }

  const std::string name;    // empty: the only one
  const std::string prefix;  // "north:"; empty: none
  StationIdentity& station;
  Domain domain;
  ClockOffsets clocks;   // used by the subscription to BusStatus
  PlanParts plan_parts;  // used by the subscription to ReadPlan
  dds::DataWriter* interests = nullptr;
  // By pattern at this site and pattern of the station.
  std::map<std::string, std::map<std::string, Duration>> declared_interests;
  std::mutex mutex;                                            // protects the members below
  std::map<std::string, std::shared_ptr<void>> subscriptions;  // by topic
  std::unique_ptr<BlockSubscription> blocks;
  std::unique_ptr<CommandClient> commands;
  std::unique_ptr<HistoryClient> history;
  std::unique_ptr<ConfigurationClient> configurations;
};

}  // namespace fieldcast

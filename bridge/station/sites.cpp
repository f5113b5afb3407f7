#include "bridge/station/sites.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "bridge/base/check.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {
namespace {

constexpr char kAfterSite = ':';  // not allowed in names of sites and buses

Station::OnGone gone_at_site(const Station::OnGone& gone, const std::string& prefix) {
  if (!gone || prefix.empty()) return gone;
  return [gone, prefix](const std::string& bus, const std::string& device,
                        const std::string& channel) { gone(prefix + bus, device, channel); };
}

}  // namespace

std::optional<std::string> pattern_at_site(std::string_view pattern, std::string_view site) {
  if (site.empty()) return std::string(pattern);
  const auto slash = pattern.find('/');
  const std::string_view bus = pattern.substr(0, slash);
  const std::string_view rest = slash == pattern.npos ? std::string_view{} : pattern.substr(slash);
  if (const auto colon = bus.find(kAfterSite); colon != bus.npos) {
    if (!glob_matches(bus.substr(0, colon), site)) return std::nullopt;
    return std::string(bus.substr(colon + 1)).append(rest);
  }
  // A star must match the end of the site's name; the last one that can leaves the longest pattern.
  const std::string prefix = std::string(site) + kAfterSite;
  for (auto star = bus.rfind('*'); star != bus.npos;
       star = star == 0 ? bus.npos : bus.rfind('*', star - 1)) {
    if (glob_matches(bus.substr(0, star + 1), prefix))
      return std::string(bus.substr(star)).append(rest);
  }
  return std::nullopt;
}

Sites::Sites(const std::vector<DdsSite>& sites, const std::string& name) {
  FIELDCAST_CHECK(!sites.empty());
  for (const DdsSite& site : sites) {
    FIELDCAST_CHECK(sites.size() == 1 || !site.name.empty());
    Site joined{site.name, site.name.empty() ? "" : site.name + kAfterSite, nullptr};
    try {
      joined.station = std::make_unique<Station>(site.dds, name);
    } catch (const DdsError& error) {
      if (site.name.empty()) throw;
      throw DdsError("site " + site.name + ": " + error.what());
    }
    sites_.push_back(std::move(joined));
  }
}

Sites::~Sites() = default;

void Sites::subscribe_samples(Station::OnSample on_sample, Station::OnGone gone) {
  share_turn(on_sample, gone);
  for (const Site& site : sites_) {
    site.station->subscribe_samples(at_site(site, on_sample), gone_at_site(gone, site.prefix));
  }
}

void Sites::subscribe_channels(std::function<void(const StationChannel&)> on_channel,
                               Station::OnGone gone) {
  share_turn(on_channel, gone);
  for (const Site& site : sites_) {
    site.station->subscribe_channels(at_site(site, on_channel), gone_at_site(gone, site.prefix));
  }
}

void Sites::subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                                 std::function<void(const StationBusStatus&)> gone) {
  subscribe_all(std::move(on_status), std::move(gone),
                [](Station& station, auto status, auto last) {
                  station.subscribe_bus_status(std::move(status), std::move(last));
                });
}

void Sites::subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                              std::function<void(const StationBridge&)> gone) {
  subscribe_all(std::move(on_bridge), std::move(gone),
                [](Station& station, auto bridge, auto last) {
                  station.subscribe_bridges(std::move(bridge), std::move(last));
                });
}

void Sites::subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                                 std::function<void(const std::string& bus)> gone) {
  share_turn(on_plan, gone);
  for (const Site& site : sites_) {
    site.station->subscribe_read_plans(at_site(site, on_plan), at_site(site, gone));
  }
}

Station::BlockCounters Sites::block_counters() const {
  Station::BlockCounters all;
  for (const Site& site : sites_) {
    const Station::BlockCounters each = site.station->block_counters();
    all.blocks += each.blocks;
    all.missing += each.missing;
    all.requests += each.requests;
  }
  return all;
}

bool Sites::may_declare_interest() const {
  return std::any_of(sites_.begin(), sites_.end(),
                     [](const Site& site) { return site.station->may_declare_interest(); });
}

void Sites::declare_interest(const std::string& pattern, Duration refresh) {
  for (const Site& site : sites_) {
    const auto there = pattern_at_site(pattern, site.name);
    if (there && (sites_.size() == 1 || site.station->may_declare_interest()))
      site.station->declare_interest(*there, refresh);
  }
}

void Sites::withdraw_interest(const std::string& pattern) {
  for (const Site& site : sites_) {
    if (const auto there = pattern_at_site(pattern, site.name))
      site.station->withdraw_interest(*there);
  }
}

Station* Sites::take_site(std::string& bus) {
  for (const Site& site : sites_) {
    if (!bus.starts_with(site.prefix)) continue;
    bus.erase(0, site.prefix.size());
    return site.station.get();
  }
  return nullptr;
}

StationOutcome Sites::execute(StationCommand command, Duration wait_for_bridge,
                              Duration wait_for_result) {
  const std::string named = command.bus;
  Station* station = take_site(command.bus);
  if (station == nullptr) return tl::unexpected(StationFault::kNoSite);
  if (command.command.request_id == 0) command.command.request_id = reserve_request_id();
  StationOutcome outcome = station->execute(std::move(command), wait_for_bridge, wait_for_result);
  if (outcome) outcome->bus = named;
  return outcome;
}

tl::expected<std::uint64_t, StationFault> Sites::send(StationCommand command,
                                                      Duration wait_for_bridge) {
  Station* station = take_site(command.bus);
  if (station == nullptr) return tl::unexpected(StationFault::kNoSite);
  if (command.command.request_id == 0) command.command.request_id = reserve_request_id();
  return station->send(std::move(command), wait_for_bridge);
}

StationOutcome Sites::execute(AlarmAction action, Duration wait_for_bridge,
                              Duration wait_for_result) {
  const std::string named = action.alarm.bus;
  Station* station = take_site(action.alarm.bus);
  if (station == nullptr) return tl::unexpected(StationFault::kNoSite);
  if (action.request_id == 0) action.request_id = reserve_request_id();
  StationOutcome outcome = station->execute(std::move(action), wait_for_bridge, wait_for_result);
  if (outcome) outcome->bus = named;
  return outcome;
}

tl::expected<std::uint64_t, StationFault> Sites::send(AlarmAction action,
                                                      Duration wait_for_bridge) {
  Station* station = take_site(action.alarm.bus);
  if (station == nullptr) return tl::unexpected(StationFault::kNoSite);
  if (action.request_id == 0) action.request_id = reserve_request_id();
  return station->send(std::move(action), wait_for_bridge);
}

StationOutcome Sites::write(std::string_view path, Value value, bool verify) {
  auto named = ChannelPath::parse(path);
  if (!named) return tl::unexpected(StationFault::kNotAPath);
  Station* station = take_site(named->bus);
  if (station == nullptr) return tl::unexpected(StationFault::kNoSite);
  StationCommand command;
  command.bus = std::move(named->bus);
  command.command.request_id = reserve_request_id();
  command.command.device = std::move(named->device);
  command.command.target = ChannelTarget{std::move(named->channel)};
  command.command.values = {std::move(value)};
  command.command.verify = verify;
  return station->execute(std::move(command));
}

void Sites::on_result(std::function<void(const StationResult&)> handler) {
  std::function<void(const StationResult&)> none;
  share_turn(handler, none);
  for (const Site& site : sites_) site.station->on_result(at_site(site, handler));
}

std::vector<std::string> Sites::missing_servers() const {
  std::vector<std::string> missing;
  for (const Site& site : sites_) {
    for (std::string& server : site.station->missing_servers()) {
      if (std::find(missing.begin(), missing.end(), server) == missing.end())
        missing.push_back(std::move(server));
    }
  }
  return missing;
}

// All stations count together: ids are reserved only here.
std::uint64_t Sites::reserve_request_id() {
  const std::lock_guard lock(reserving_);
  std::uint64_t id = 0;
  for (const Site& site : sites_) id = site.station->reserve_request_id();
  return id;
}

}  // namespace fieldcast

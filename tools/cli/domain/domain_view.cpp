#include "tools/cli/domain/domain_view.hpp"

#include <algorithm>

#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

namespace {

struct BusOf {
  std::string_view operator()(const StationResult&) const { return {}; }
  std::string_view operator()(const StationBridge&) const { return {}; }
  std::string_view operator()(const BridgeGone&) const { return {}; }
  std::string_view operator()(const ChannelGone& gone) const { return gone.path.bus; }
  std::string_view operator()(const AlarmGone& gone) const { return gone.last.bus; }
  std::string_view operator()(const StationAlarmStatus& one) const { return one.alarm.bus; }
  std::string_view operator()(const AlarmStatusGone& gone) const { return gone.last.alarm.bus; }
  template <class Named>
  std::string_view operator()(const Named& named) const {
    return named.bus;
  }
};

}  // namespace

std::string_view bus_of(const DomainEvent& event) { return std::visit(BusOf{}, event); }

bool update(StatusModel& model, const DomainEvent& event) {
  if (const auto* bus = std::get_if<StationBusStatus>(&event))
    return model.buses.insert_or_assign(bus->bus, *bus).second;
  if (const auto* device = std::get_if<StationDeviceStatus>(&event))
    return model.devices.insert_or_assign({device->bus, device->device}, *device).second;
  if (const auto* bus = std::get_if<BusGone>(&event)) model.buses.erase(bus->bus);
  if (const auto* device = std::get_if<DeviceGone>(&event))
    model.devices.erase({device->bus, device->device});
  if (const auto* bridge = std::get_if<StationBridge>(&event))
    model.bridges.insert_or_assign(bridge->bridge, *bridge);
  if (const auto* bridge = std::get_if<BridgeGone>(&event)) model.bridges.erase(bridge->bridge);
  return false;
}

DomainView::DomainView(const Connection& connection, Interrupt& interrupt)
    : interrupt_(interrupt), station_(connection.sites, "fieldcast-cli") {
  interrupt_.on_raise([this] { inbox_.close(); });
}

DomainView::~DomainView() { interrupt_.on_raise({}); }

void DomainView::subscribe_channels() { station_.subscribe_channels(put(), put_gone()); }

void DomainView::subscribe_samples() { station_.subscribe_samples(put(), put_gone()); }

void DomainView::subscribe_status() {
  station_.subscribe_bus_status(
      put(), [this](const StationBusStatus& last) { inbox_.put_newest(BusGone{last.bus}); });
  station_.subscribe_device_status(put(), [this](const StationDeviceStatus& last) {
    inbox_.put_newest(DeviceGone{last.bus, last.device});
  });
  station_.subscribe_bridges(
      put(), [this](const StationBridge& last) { inbox_.put_newest(BridgeGone{last.bridge}); });
}

void DomainView::subscribe_alarms() {
  station_.subscribe_alarms(
      put(), [this](const StationAlarm& last) { inbox_.put_newest(AlarmGone{last}); });
  station_.subscribe_alarm_status(
      put(), [this](const StationAlarmStatus& last) { inbox_.put_newest(AlarmStatusGone{last}); });
}

void DomainView::subscribe_results() { station_.on_result(put()); }

void DomainView::subscribe_program_sessions() {
  station_.subscribe_bus_status(put());
  station_.subscribe<ProgramSessionReport>(put());
}

Listening::Listening(const Connection& connection, Instant began)
    : began_(began), last_news_(began) {
  for (const DdsSite& site : connection.sites) sites_.push_back({site.name});
}

bool Listening::is_of(const Site& site, std::string_view bus) {
  return site.name.empty() || (bus.size() > site.name.size() && bus.starts_with(site.name) &&
                               bus[site.name.size()] == ':');
}

void Listening::news(std::string_view bus, Instant now) {
  anybody_ = true;
  last_news_ = now;
  for (Site& site : sites_) site.heard = site.heard || is_of(site, bus);
}

bool Listening::heard_site_of(std::string_view bus) const {
  const auto site =
      std::ranges::find_if(sites_, [&](const Site& each) { return is_of(each, bus); });
  return site == sites_.end() ? anybody_ : site->heard;
}

Instant Listening::over_at() const {
  const Instant quiet_at = last_news_ + kQuietTime;
  const bool all = std::ranges::all_of(sites_, [](const Site& site) { return site.heard; });
  return all ? quiet_at : std::max(began_ + kBridgeWait, anybody_ ? quiet_at : began_);
}

std::vector<std::string> Listening::silent_sites() const {
  std::vector<std::string> names;
  for (const Site& site : sites_) {
    if (!site.heard && sites_.size() > 1) names.push_back(site.name);
  }
  return names;
}

std::string Listening::silent_text() const {
  std::string text;
  for (const std::string& name : silent_sites())
    text += (text.empty() ? "no bridge found in site " : ", ") + name;
  return text;
}

namespace {

constexpr Duration kLook = std::chrono::milliseconds{50};

}  // namespace

StandbyWatch::StandbyWatch(const Connection& connection) {
  for (const DdsSite& site : connection.sites) {
    sites_.push_back(std::make_unique<StandbyMonitor>(
        site.dds, "fieldcast-cli",
        StandbyMonitor::Handlers{[this](const StandbyMessage& message) { learn(message); },
                                 [this](const std::string& group, const std::string& bridge) {
                                   const std::lock_guard lock(mutex_);
                                   model_.erase({group, bridge});
                                 }}));
  }
}

bool StandbyWatch::request(const StandbyRequest& wanted, Duration limit) {
  bool heard = false;
  for (const auto& site : sites_) heard |= site->request(wanted, limit);
  return heard;
}

StandbyModel StandbyWatch::model() {
  const std::lock_guard lock(mutex_);
  return model_;
}

bool StandbyWatch::until(const std::function<bool(const StandbyModel&)>& condition, Instant end,
                         const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  while (!condition(model_)) {
    if (give_up() || instant_now() >= end) return false;
    changed_.wait_for(lock, kLook);
  }
  return true;
}

void StandbyWatch::learn(const StandbyMessage& message) {
  const std::lock_guard lock(mutex_);
  const std::pair key{message.group, message.member.bridge};
  if (message.member.role == StandbyRole::kLeft) {
    model_.erase(key);
  } else {
    model_.insert_or_assign(key, message);
  }
  changed_.notify_all();
}

}  // namespace fieldcast::cli

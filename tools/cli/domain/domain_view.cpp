#include "tools/cli/domain/domain_view.hpp"

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

void DomainView::subscribe_channels() {
  station_.subscribe_channels([this](const StationChannel& channel) { inbox_.put_newest(channel); },
                              [this](const auto& bus, const auto& device, const auto& channel) {
                                inbox_.put_newest(ChannelGone{{bus, device, channel}});
                              });
}

void DomainView::subscribe_samples() {
  station_.subscribe_samples([this](const StationSample& sample) { inbox_.put_newest(sample); },
                             [this](const auto& bus, const auto& device, const auto& channel) {
                               inbox_.put_newest(ChannelGone{{bus, device, channel}});
                             });
}

void DomainView::subscribe_status() {
  station_.subscribe_bus_status(
      [this](const StationBusStatus& status) { inbox_.put_newest(status); },
      [this](const StationBusStatus& last) { inbox_.put_newest(BusGone{last.bus}); });
  station_.subscribe_device_status(
      [this](const StationDeviceStatus& status) { inbox_.put_newest(status); },
      [this](const StationDeviceStatus& last) {
        inbox_.put_newest(DeviceGone{last.bus, last.device});
      });
  station_.subscribe_bridges(
      [this](const StationBridge& bridge) { inbox_.put_newest(bridge); },
      [this](const StationBridge& last) { inbox_.put_newest(BridgeGone{last.bridge}); });
}

void DomainView::subscribe_alarms() {
  station_.subscribe_alarms(
      [this](const StationAlarm& alarm) { inbox_.put_newest(alarm); },
      [this](const StationAlarm& last) { inbox_.put_newest(AlarmGone{last}); });
  station_.subscribe_alarm_status(
      [this](const StationAlarmStatus& status) { inbox_.put_newest(status); },
      [this](const StationAlarmStatus& last) { inbox_.put_newest(AlarmStatusGone{last}); });
}

void DomainView::subscribe_results() {
  station_.on_result([this](const StationResult& result) { inbox_.put_newest(result); });
}

void DomainView::subscribe_program_sessions() {
  station_.subscribe_bus_status(
      [this](const StationBusStatus& status) { inbox_.put_newest(status); });
  station_.subscribe_program_sessions(
      [this](const ProgramSessionReport& session) { inbox_.put_newest(session); });
}

}  // namespace fieldcast::cli

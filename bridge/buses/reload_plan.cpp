#include "bridge/buses/reload_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

const BusSpec* find_bus(const BridgeSpec& bridge, const std::string& name) {
  const auto found = std::find_if(bridge.buses.begin(), bridge.buses.end(),
                                  [&](const BusSpec& bus) { return bus.name == name; });
  return found == bridge.buses.end() ? nullptr : &*found;
}

std::vector<std::string> changes_of_all(const BridgeSpec& running, const BridgeSpec& wanted) {
  std::vector<std::string> changes;
  if (running.name != wanted.name)
    changes.push_back(fmt::format("the bridge {} is now called {}", running.name, wanted.name));
  if (running.standby != wanted.standby) changes.emplace_back("its standby group has changed");
  if (running.dds.domain != wanted.dds.domain)
    changes.push_back(
        fmt::format("its DDS domain is {}, it was {}", wanted.dds.domain, running.dds.domain));
  else if (running.dds != wanted.dds)
    changes.emplace_back("its DDS settings have changed");
  if (running.store && !wanted.store)
    changes.emplace_back("it has no store any more");
  else if (wanted.store && !running.store)
    changes.emplace_back("it has a store now");
  else if (running.store != wanted.store)
    changes.emplace_back("its store has changed");
  return changes;
}

// A capture starts and ends without a restart of its bus.
bool same_but_capture(const BusSpec& running, BusSpec wanted) {
  wanted.capture = running.capture;
  return running == wanted;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

ReloadPlan plan_reload(const BridgeSpec& running, const BridgeSpec& wanted) {
  ReloadPlan plan;
  plan.whole_bridge = changes_of_all(running, wanted);
  if (!plan.whole_bridge.empty()) return plan;
  plan.program = running.program != wanted.program;
  plan.metrics = running.metrics != wanted.metrics;
  for (const BusSpec& bus : running.buses) {
    const BusSpec* same = find_bus(wanted, bus.name);
    if (!same || !same_but_capture(bus, *same)) plan.stop.push_back(bus.name);
  }
  for (const BusSpec& bus : wanted.buses) {
    const BusSpec* same = find_bus(running, bus.name);
    const bool goes_on = same && same_but_capture(*same, bus);
    (goes_on ? plan.untouched : plan.start).push_back(bus.name);
  }
  return plan;
}

std::vector<program::LeasedDevice> disturbed_by(const ReloadPlan& plan, const BridgeSpec& wanted,
                                                const std::vector<program::LeasedDevice>& leased) {
  if (!plan.whole_bridge.empty() || plan.program) return leased;
  // A module without a bus gets one.
  const auto begins = [&](const std::string& number) {
    return std::any_of(wanted.buses.begin(), wanted.buses.end(), [&](const BusSpec& bus) {
      const auto* dial_in = std::get_if<DialInPortSpec>(&bus.port);
      return dial_in && dial_in->number == number && contains(plan.start, bus.name);
    });
  };
  std::vector<program::LeasedDevice> disturbed;
  std::copy_if(leased.begin(), leased.end(), std::back_inserter(disturbed),
               [&](const program::LeasedDevice& device) {
                 return contains(plan.stop, device.bus) || begins(device.number);
               });
  return disturbed;
}

std::string to_text(const ReloadPlan& plan) {
  const auto names = [](const std::vector<std::string>& listed) {
    return listed.empty() ? std::string{} : fmt::format(" ({})", fmt::join(listed, ", "));
  };
  return fmt::format("reloaded: {} stopped{}, {} started{}, {} untouched",
                     counted(plan.stop.size(), "bus", "buses"), names(plan.stop), plan.start.size(),
                     names(plan.start), plan.untouched.size());
}

std::optional<AlarmChange> end_of_alarm(const BridgeSpec& running, const AlarmRecord& alarm,
                                        Instant now) {
  const BusSpec* bus = find_bus(running, alarm.bus);
  const auto limit = limit_kind_from(alarm.limit);
  if (bus == nullptr || !limit) return std::nullopt;
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus->devices) {
    for (const ChannelSpec& channel : device.channels) {
      if (device.name == alarm.device && channel.name == alarm.channel)
        return AlarmChange{index, *limit, AlarmState::kClear, alarm.value, now};
      ++index;
    }
  }
  return std::nullopt;
}

}  // namespace fieldcast

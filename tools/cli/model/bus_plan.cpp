#include "tools/cli/model/bus_plan.hpp"

#include <algorithm>

#include "core/model/bus_spec.hpp"
#include "tools/sim/bus/virtual_bus.hpp"

namespace fieldcast::cli {

namespace {

class Steps {
 public:
  Steps(sim::VirtualBus& bus, Duration length, const OnSimulated& on_simulated)
      : bus_(bus), length_(length), on_simulated_(on_simulated) {}

  void run_until(Instant until) {
    constexpr int kSteps = 200;
    const Duration step = std::max<Duration>(length_ / kSteps, std::chrono::milliseconds{1});
    while (on_simulated_ && bus_.now() + step < until) {
      bus_.run_until(bus_.now() + step);
      on_simulated_(to_seconds(bus_.now() - Instant{}) / to_seconds(length_));
    }
    bus_.run_until(until);
  }

 private:
  sim::VirtualBus& bus_;
  const Duration length_;
  const OnSimulated& on_simulated_;
};

void run(sim::VirtualBus& bus, const sim::BusFaults& faults, Instant end, Steps steps) {
  for (const sim::Window& window : faults.unplugged) {
    if (window.from >= end - Instant{}) break;
    steps.run_until(Instant{window.from});
    if (bus.plugged()) bus.unplug();
    const Instant back = window.to == sim::kForever ? end : std::min(end, Instant{window.to});
    steps.run_until(back);
    if (back < end) bus.plug();
  }
  steps.run_until(end);
}

}  // namespace

BusSimulation simulate(const BusPlan& plan, const sim::BusFaults& faults,
                       const SimulationOptions& options, const OnSimulated& on_simulated) {
  sim::BusFaults all = faults;
  std::ranges::sort(all.unplugged, {}, &sim::Window::from);
  for (const DeviceSpec& device : plan.bus->devices) {
    all.devices.try_emplace(device.name).first->second.delay.base =
        faults.devices.contains(device.name) ? faults.devices.at(device.name).delay.base
                                             : plan.response_time;
  }
  sim::VirtualBus bus(*plan.bus, all, options.seed);
  (void)bus.engine().bus_report(bus.now());
  run(bus, all, Instant{options.length}, Steps(bus, options.length, on_simulated));

  BusSimulation result;
  result.plan = &plan;
  result.options = options;
  result.bus = bus.engine().bus_report(bus.now());
  ChannelIndex channel = 0;
  for (DeviceIndex device = 0; device < plan.bus->devices.size(); ++device) {
    result.devices.push_back(bus.engine().device_report(device, bus.now()));
    for (std::size_t i = 0; i < plan.bus->devices[device].channels.size(); ++i)
      result.channels.push_back(bus.engine().channel_report(channel++, bus.now()));
  }
  result.fingerprint = bus.fingerprint();
  return result;
}

}  // namespace fieldcast::cli

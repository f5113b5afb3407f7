#include "bridge/metrics/metrics_snapshot.hpp"

#include <fmt/format.h>

namespace fieldcast {

std::string silent_bus(const MetricsSnapshot& snapshot, Instant now) {
  for (const auto& figures : snapshot.buses) {
    const Duration silent = now - figures->reported;
    if (silent > kSilentBus)
      return fmt::format("{}: no report for {:.0f} s", figures->bus, to_seconds(silent));
  }
  return {};
}

// The old value is destroyed after the lock is released.
void MetricsTable::note(BusFigures figures) {
  auto made = std::make_shared<const BusFigures>(std::move(figures));
  const std::lock_guard lock(mutex_);
  buses_[made->bus].swap(made);
}

void MetricsTable::note(DeviceFigures figures) {
  auto made = std::make_shared<const DeviceFigures>(std::move(figures));
  const std::lock_guard lock(mutex_);
  devices_[{made->bus, made->device}].swap(made);
}

void MetricsTable::note(GatewayFigures figures) {
  const std::lock_guard lock(mutex_);
  gateways_[figures.bus] = std::move(figures);
}

void MetricsTable::remove(std::string_view bus) {
  const std::lock_guard lock(mutex_);
  if (const auto found = buses_.find(bus); found != buses_.end()) buses_.erase(found);
  if (const auto found = gateways_.find(bus); found != gateways_.end()) gateways_.erase(found);
  std::erase_if(devices_, [bus](const auto& device) { return device.first.first == bus; });
}

void MetricsTable::copy_to(MetricsSnapshot& snapshot) const {
  const std::lock_guard lock(mutex_);
  snapshot.buses.reserve(buses_.size());
  snapshot.devices.reserve(devices_.size());
  for (const auto& [name, figures] : buses_) snapshot.buses.push_back(figures);
  for (const auto& [name, figures] : devices_) snapshot.devices.push_back(figures);
  for (const auto& [name, figures] : gateways_) snapshot.gateways.push_back(figures);
}

}  // namespace fieldcast

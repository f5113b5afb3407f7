#include "bridge/publish/store_recorder.hpp"

#include <fmt/format.h>

namespace fieldcast {

StoreRecorder::StoreRecorder(Store& store, const BusSpec& bus)
    : store_(store), bus_(bus.name), intake_(store.intake(bus)) {
  for (const DeviceSpec& device : bus.devices)
    devices_[device.name] = {
        device.protocol, fmt::format("{}, {}", to_text(bus.port), device.link.address), {}};
}

void StoreRecorder::put(std::span<const Sample> samples, const UtcMapping& mapping, Instant now) {
  intake_->put(samples, mapping, mapping.to_utc(now));
}

void StoreRecorder::put(std::string_view device, DeviceState state, UtcTime at) {
  const auto found = devices_.find(device);
  if (found == devices_.end() || found->second.state == state) return;
  found->second.state = state;
  store_.put(DeviceRecord{bus_, found->first, found->second.protocol, found->second.address,
                          std::string(to_text(state)), at});
}

}  // namespace fieldcast

// The contents of the simulated devices of a bus as values of its channels, to check good values.
//
// Reads and fills the devices, which must outlive it. One thread; throws std::runtime_error for a
// device that cannot be filled or read.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"
#include "core/protocol/protocol.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::test {

class PlantMemory {
 public:
  // A response that is late by this time may still contain the previous value.
  static constexpr Duration kOldValueMayCome = std::chrono::seconds{2};
  using DeviceOf = std::function<sim::SimDevice&(DeviceIndex)>;

  // `whole`: all channels of all configurations; it must outlive this object.
  PlantMemory(const BusSpec& whole, DeviceOf device_of);

  // From now on channels are numbered as in `spec`, which must not change.
  void begin(const BusSpec& spec, Instant now);
  // Fills the device with random contents, as after a restart.
  void fill(DeviceIndex device, std::mt19937_64& random, Instant now);
  void look(ChannelIndex channel, Instant now);
  [[nodiscard]] const Value& holds(ChannelIndex channel) const { return channels_[channel].holds; }
  // Returns the error, or empty if the device contained `value` within kOldValueMayCome.
  [[nodiscard]] std::optional<std::string> wrong(ChannelIndex channel, const Value& value,
                                                 Instant now);

 private:
  struct Channel {
    DeviceIndex device = 0;
    const ChannelSpec* spec = nullptr;
    const Area* area = nullptr;
    Value holds, held;  // present value, and the value before `changed`
    Instant changed = kLongAgo;
  };
  void look_all(DeviceIndex device, Instant now);
  [[nodiscard]] Value memory(const Channel& channel, Instant now) const;

  const BusSpec& whole_;
  const DeviceOf device_of_;
  std::vector<std::unique_ptr<Protocol>> protocols_;  // of each device
  std::vector<Channel> channels_;
};

}  // namespace fieldcast::test

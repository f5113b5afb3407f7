// What the simulated devices of a bus hold, as its channels show it: good values are judged by it.
//
// Reads and fills the devices, which outlive it. One thread; throws std::runtime_error for a device
// that cannot be filled or read.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::test {

class PlantMemory {
 public:
  // An answer that was late by this much may still tell the value of before.
  static constexpr Duration kOldValueMayCome = std::chrono::seconds{2};
  using DeviceOf = std::function<sim::SimDevice&(DeviceIndex)>;

  // `whole`: all channels that there ever are. It outlives the memory.
  PlantMemory(const BusSpec& whole, DeviceOf device_of);

  // From here on channels are numbered as in `spec`, which stays as it is.
  void begin(const BusSpec& spec, Instant now);
  // New contents, as after a restart of the device.
  void fill(DeviceIndex device, std::mt19937_64& random, Instant now);
  // Looks what the device holds by now.
  void look(ChannelIndex channel, Instant now);
  [[nodiscard]] const Value& holds(ChannelIndex channel) const { return channels_[channel].holds; }
  // What the device held a moment ago is right. Nothing: the value is right.
  [[nodiscard]] std::optional<std::string> wrong(ChannelIndex channel, const Value& value,
                                                 Instant now);

 private:
  struct Channel {
    DeviceIndex device = 0;
    const ChannelSpec* spec = nullptr;
    const Area* area = nullptr;
    Value holds, held;  // the device's memory, and what it was before `changed`
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

// A simulated device whose items are in an ItemMemory. Owned as SimDevice.
#pragma once

#include <optional>
#include <string_view>
#include <utility>

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

class MemoryDevice : public SimDevice {
 public:
  [[nodiscard]] const DeviceStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] std::optional<std::uint64_t> peek(std::string_view area, std::uint32_t item,
                                                  Instant now) override {
    return memory_.peek(area, item, now);
  }
  bool poke(std::string_view area, std::uint32_t item, std::uint64_t bits) override {
    return memory_.poke(area, item, bits);
  }
  [[nodiscard]] ItemMemory& memory() { return memory_; }

 protected:
  explicit MemoryDevice(ItemMemory memory) : memory_(std::move(memory)) {}

  ItemMemory memory_;
  DeviceStatistics statistics_;
};

}  // namespace fieldcast::sim

// Memory of a simulated device as numbered items of several areas. Owned by one device.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/waveform.hpp"

namespace fieldcast::sim {

struct ItemArea {
  std::string_view name;
  unsigned bits = 16;  // of one item: 1, 8, 16, 32 or 64
  std::uint32_t items = 65536;
  bool only_bools = false;  // of bits: bits that follow each other are no number
};

struct ItemAddress {
  std::size_t area = 0;
  std::uint32_t first = 0;
  std::optional<std::uint8_t> bit;  // bit of an item wider than a bit; for a byte its lowest bit
};

class ItemMemory {
 public:
  ItemMemory(std::vector<ItemArea> areas, const DeviceSetup& setup);

  // Adds a channel: its items follow the waveform until they are written. Items narrower than the
  // value contain it from its highest byte on, bit items from its lowest bit. An item wider than
  // the value contains only this value. Returns false if it exceeds the area.
  bool add_channel(const ItemAddress& at, const Encoding& encoding, const Waveform& waveform);
  // `parse` parses the addresses.
  [[nodiscard]] tl::expected<void, std::string> add_channels(
      const DeviceSetup& setup,
      const std::function<std::optional<ItemAddress>(std::string_view at)>& parse);

  // Returns the bits, right-aligned. REQUIRES: the area and the item exist.
  [[nodiscard]] std::uint64_t read(std::size_t area, std::uint32_t item, Instant now) const;
  void write(std::size_t area, std::uint32_t item, std::uint64_t bits) {
    written_[area][item] = bits;
  }
  void write(std::size_t area, std::uint32_t item, std::uint64_t bits,
             DeviceStatistics& statistics);

  // Returns the code of a refused range, `missing` for missing items, or 0.
  [[nodiscard]] std::uint8_t refusal(std::size_t area, std::uint32_t first, std::uint32_t count,
                                     std::uint8_t missing) const;
  [[nodiscard]] bool configured(std::size_t area, std::uint32_t item) const {
    return parts_[area].contains(item);
  }
  // Configured, or written.
  [[nodiscard]] bool holds(std::size_t area, std::uint32_t item) const {
    return configured(area, item) || written_[area].contains(item);
  }
  [[nodiscard]] std::optional<std::uint64_t> peek(std::string_view area, std::uint32_t item,
                                                  Instant now) const;
  bool poke(std::string_view area, std::uint32_t item, std::uint64_t bits);

 private:
  struct Channel {
    ItemAddress at;
    Encoding encoding;
    Waveform waveform;
  };
  struct Part {
    std::size_t channel = 0;
    unsigned index = 0;  // index among the items of the channel
  };
  [[nodiscard]] std::optional<std::size_t> find(std::string_view area, std::uint32_t item) const;
  [[nodiscard]] std::uint64_t bits_of(const Part& part, unsigned width, Instant now) const;

  const std::vector<ItemArea> areas_;
  const std::vector<RefusedRange> refused_;
  const bool only_configured_;
  const Instant start_;
  std::vector<Channel> channels_;
  std::vector<std::multimap<std::uint32_t, Part>> parts_;
  std::vector<std::unordered_map<std::uint32_t, std::uint64_t>> written_;
};

// A simulated device whose items are in an ItemMemory. Owned as SimDevice.
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

// Makes a device with the channels of `setup`. Fails for an address above `highest`, or an invalid
// channel address.
template <class Device, class Parse>
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_memory_device(
    const DeviceSetup& setup, unsigned highest, const Parse& parse,
    std::string_view what = "address") {
  if (setup.spec.link.address > highest) {
    return tl::unexpected(fmt::format("{}: {} {} is not 0..{}", setup.spec.name, what,
                                      setup.spec.link.address, highest));
  }
  auto device = std::make_unique<Device>(setup);
  if (auto added = device->memory().add_channels(setup, parse); !added)
    return tl::unexpected(added.error());
  return device;
}

}  // namespace fieldcast::sim

// A simulated S7-200 station with the freeport program. Written from the rules alone, apart from
// the bridge's codec: they share the XOR.
//
//     request   q DT DA DA LE LE DU*8 FC FC Q     17 characters
//     answer    q DU*8 FC FC Q                    12
//     refusal   q E CC CC FC FC Q                  7
//
// Codes of a refusal: 01 check, 02 length, 03 digits, 04 command.
//
// Its program shows what is written to it in its read window, but for bytes of channels that are
// read-only.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 1> kFreeportAreaNames{"window"};

class FreeportDevice : public SimDevice {
 public:
  explicit FreeportDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;
  [[nodiscard]] const DeviceStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] std::optional<std::uint64_t> peek(std::string_view area, std::uint32_t item,
                                                  Instant now) override {
    return memory_.peek(area, item, now);
  }
  bool poke(std::string_view area, std::uint32_t item, std::uint64_t bits) override {
    return memory_.poke(area, item, bits);
  }
  [[nodiscard]] ItemMemory& memory() { return memory_; }

  // A frame from `q` to `Q`. What to answer; empty where silence is right.
  [[nodiscard]] Bytes take(ByteView frame, Instant now);

 private:
  static constexpr std::uint32_t kBytes = 4;
  [[nodiscard]] Bytes refuse(std::uint8_t code);
  [[nodiscard]] Bytes show(std::uint32_t length, Instant now) const;
  [[nodiscard]] Bytes store(ByteView data, std::uint32_t length);

  const std::uint8_t station_;
  const char read_, write_;  // the letters that its program takes for them
  ItemMemory memory_;
  std::array<std::uint8_t, kBytes> written_{};
  std::array<bool, kBytes> mirrored_;
  DeviceStatistics statistics_;
};

// Refuses, with a text for people, a station outside 0..255, and a channel whose address is no
// place in the window.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_freeport_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim

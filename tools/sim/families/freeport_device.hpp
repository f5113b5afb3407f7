// A simulated S7-200 station with the freeport program. Implemented from the specification only,
// independent of the bridge's codec except for the XOR.
//
//     request   q DT DA DA LE LE DU*8 FC FC Q     17 characters
//     response  q DU*8 FC FC Q                    12
//     refusal   q E CC CC FC FC Q                  7
//
// Refusal codes: 01 check, 02 length, 03 digits, 04 command.
//
// The program copies written bytes to its read window, except bytes of read-only channels.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 1> kFreeportAreaNames{"window"};

class FreeportDevice : public MemoryDevice {
 public:
  explicit FreeportDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  // `frame`: from `q` to `Q`. Returns an empty response to stay silent.
  [[nodiscard]] Bytes take(ByteView frame, Instant now);

 private:
  static constexpr std::uint32_t kBytes = 4;
  [[nodiscard]] Bytes refuse(std::uint8_t code);
  [[nodiscard]] Bytes show(std::uint32_t length, Instant now) const;
  [[nodiscard]] Bytes store(ByteView data, std::uint32_t length);

  const std::uint8_t station_;
  const char read_, write_;  // command letters of the program
  std::array<std::uint8_t, kBytes> written_{};
  std::array<bool, kBytes> mirrored_;
};

// Fails for a station outside 0..255 or a channel address outside the window.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_freeport_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim

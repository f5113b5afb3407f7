// A simulated SLC 500 or MicroLogix on DF1. Implemented from the manual 1770-6.5.16 only,
// independent of the bridge's codec except for the checksums.
//
//     full duplex   10 02 command 10 03 check          ->  10 06, 10 02 response 10 03 check
//     half duplex   10 01 STN 10 02 command 10 03 check  ->  10 06
//                   10 05 STN BCC                      ->  10 04, or the response
//
// It keeps a response until it is acknowledged, and sends the next one only then. With full duplex
// it requests a missing acknowledgement with an ENQ. A command with the header of the one before is
// acknowledged without a second response.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <string>

#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 10> kDf1AreaNames{"N", "B", "F", "L", "T",
                                                                "C", "R", "S", "O", "I"};

class Df1Device : public MemoryDevice {
 public:
  explicit Df1Device(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  // `packet`: a command with a valid check. Returns the packet of the response; empty: none.
  [[nodiscard]] Bytes execute(ByteView packet, Instant now);
  void bad_frame() { ++statistics_.bad_frames; }

 private:
  struct Target {
    std::size_t area = 0;
    std::uint32_t first = 0, count = 0;
  };
  // `at`: of the file number, moved behind the address fields. Empty for an invalid address.
  [[nodiscard]] std::optional<Target> target_of(ByteView packet, std::size_t& at) const;
  [[nodiscard]] std::uint8_t refusal_of(const Target& target) const;
  [[nodiscard]] Bytes read(const Target& target, Instant now) const;
  void write(const Target& target, ByteView data);
  void write_masked(const Target& target, ByteView mask, ByteView data, Instant now);

  const std::uint8_t node_;
  const bool crc_, half_duplex_;
};

[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_df1_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim

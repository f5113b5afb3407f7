// LZW over nibbles for the simulated DTC device, independent of the bridge's implementation.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "core/base/bytes.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

[[nodiscard]] Bytes dtc_compress(ByteView message);

// Empty if the codes do not decode to `length` bytes. REQUIRES: length <= 4096.
[[nodiscard]] std::optional<Bytes> dtc_expand(ByteView codes, std::size_t length);

inline constexpr std::array<std::string_view, 5> kDtcAreaNames{"bit", "int16", "int32", "float32",
                                                               "float64"};
inline constexpr std::array<unsigned, 5> kDtcBits{1, 16, 32, 32, 64};  // of one variable

// "int16:100" or "int16:100.3"; independent of the bridge's parser.
[[nodiscard]] std::optional<ItemAddress> parse_dtc_address(std::string_view at);

// A simulated DTC device. Implemented from the specification only, independent of the bridge's
// codec except for the checksum.
//
//     packet    flag(1) length(2) body         flag 0: the message
//                                              flag 1: the message's length(2), then LZW codes
//     message   address command group.. CRC
//
// Has the bridge's options max-message, and threshold for sent messages (default and `auto`: 24
// bytes).
class DtcDevice : public MemoryDevice {
 public:
  explicit DtcDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  // `body`: of a complete packet. Empty `response`: stay silent. Returns false if invalid.
  bool take(bool compressed, ByteView body, Instant now, Bytes& response);

 private:
  struct Group {
    std::uint8_t type = 0;
    std::uint16_t first = 0, count = 0;
    ByteView data;  // of a write
  };
  [[nodiscard]] Bytes execute(ByteView message, Instant now);
  [[nodiscard]] tl::expected<std::vector<Group>, std::uint8_t> groups_of(ByteView bytes,
                                                                         bool write) const;
  [[nodiscard]] std::uint8_t refusal_of(const Group& group) const;  // 0: none
  [[nodiscard]] Bytes packet(Bytes message) const;
  void store(const Group& group);
  void append_values(const Group& group, Instant now, Bytes& out) const;

  const std::uint8_t address_;
  const LineFormat line_;
  const bool stream_;
  std::size_t max_message_ = 1024, threshold_ = 24;
};

// Fails for an address outside 0..255, an invalid option, or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_dtc_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim

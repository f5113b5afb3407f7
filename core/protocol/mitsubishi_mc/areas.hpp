// Devices of the MC protocol with their codes ("Device code list" in 8.1 of the MELSEC
// communication protocol reference manual, SH-080008; the SLMP reference manual, SH-080956, has the
// same list).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::mitsubishi_mc {

struct DeviceRow {
  std::string_view name;   // its code in ASCII, without the asterisks that fill it
  std::string_view other;  // name in the iQ-R series, if different
  std::uint8_t code = 0;
  std::uint8_t base = 10;        // of its numbers as the programming software writes them
  std::uint8_t ascii_base = 10;  // of its numbers in ASCII code
  unsigned item_bits = 16;       // 1 or 16
  std::uint32_t items = 0;       // largest range of the PLCs
  bool writable = true;
  std::optional<ValueType> type = std::nullopt;  // see Area::type
};

// In the order of Protocol::areas().
struct Reached {
  std::vector<const DeviceRow*> rows;
  std::vector<Area> areas;
};
// Points of one request.
struct AreaLimits {
  std::uint16_t words = 0, read_bits = 0, write_bits = 0;
};
[[nodiscard]] Reached reached_from(std::span<const DeviceRow> rows, const AreaLimits& limits);
[[nodiscard]] const Reached& reached_by(const Format& format);

// The notation of parse_address() for the devices of `reached`.
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_device(const Reached& reached,
                                                                     const AddressFaults& fault,
                                                                     std::string_view at);

// "D100", "D100.5", "D100.F", "W1A0" (hexadecimal), "M14", "X1F" (hexadecimal), "TN5", "CS3".
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(const Format& format,
                                                                      std::string_view at);

}  // namespace fieldcast::mitsubishi_mc

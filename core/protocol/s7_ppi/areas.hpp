#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::s7_ppi {

struct AreaCode {
  std::uint8_t code = 0;
  std::uint8_t transport = 2;  // TS: 02 bytes, 04 words, or the area code itself
  std::uint8_t item_size = 1;  // maximum bytes of one item in a response
  bool counted = false;        // addressed by number instead of by bit
};

// Data in a PDU of 240 bytes (computed as in libnodave).
inline constexpr std::uint16_t kMaxRead = 222, kMaxWrite = 212;

enum : AreaIndex { kV, kM, kI, kQ, kS, kSM, kAI, kAQ, kT, kC, kHC, kAreaCount };

constexpr Area bytes(std::string_view name, std::uint32_t items, std::uint16_t max_read,
                     bool writable) {
  const std::uint16_t max_write = max_read < kMaxWrite ? max_read : kMaxWrite;
  return {.name = name,
          .item_bits = 8,
          .items = items,
          .writable = writable,
          .max_read = max_read,
          .max_write = writable ? max_write : std::uint16_t{0},
          .bit_write = writable};
}
constexpr Area numbers(std::string_view name, ValueType type, std::uint32_t items,
                       std::uint16_t max_read, bool writable = false) {
  return {.name = name,
          .item_bits = type == ValueType::kInt32 ? 32u : 16u,
          .type = type,
          .items = items,
          .writable = writable,
          .max_read = max_read,
          .max_write = writable ? max_read : std::uint16_t{0}};
}
// Sizes of the largest CPU (226); a smaller one refuses the rest. Only forcing writes I.
inline constexpr std::array<Area, kAreaCount> kAreas{
    bytes("V", 10240, kMaxRead, true),
    bytes("M", 32, 32, true),
    bytes("I", 16, 16, false),
    bytes("Q", 16, 16, true),
    bytes("S", 32, 32, false),
    bytes("SM", 550, kMaxRead, true),
    numbers("AI", ValueType::kInt16, 32, 32),
    numbers("AQ", ValueType::kInt16, 32, 32, true),
    numbers("T", ValueType::kInt32, 256, kMaxRead / 5),
    numbers("C", ValueType::kInt16, 256, kMaxRead / 3),
    numbers("HC", ValueType::kInt32, 6, 6)};
inline constexpr std::array<AreaCode, kAreaCount> kCodes{{
    {.code = 0x84},
    {.code = 0x83},
    {.code = 0x81},
    {.code = 0x82},
    {.code = 0x04},
    {.code = 0x05},
    {.code = 0x06, .transport = 0x04, .item_size = 2},
    {.code = 0x07, .transport = 0x04, .item_size = 2},
    {.code = 0x1F, .transport = 0x1F, .item_size = 5, .counted = true},  // status and four bytes
    {.code = 0x1E, .transport = 0x1E, .item_size = 3, .counted = true},  // status and a word
    {.code = 0x20, .transport = 0x20, .item_size = 5, .counted = true},
}};

// "VB100", "VW100", "VD204", "V10.3", "I0.3", "SMB28", "AIW4", "T37", "C5", "HC0".
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at);

}  // namespace fieldcast::s7_ppi

#pragma once

#include <array>
#include <cstdint>

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

// Sizes of the largest CPU (226); a smaller one refuses the rest.
inline constexpr std::array<Area, kAreaCount> kAreas{{
    {.name = "V",
     .item_bits = 8,
     .items = 10240,
     .writable = true,
     .max_read = kMaxRead,
     .max_write = kMaxWrite,
     .bit_write = true},
    {.name = "M",
     .item_bits = 8,
     .items = 32,
     .writable = true,
     .max_read = 32,
     .max_write = 32,
     .bit_write = true},
    // Only forcing writes it.
    {.name = "I", .item_bits = 8, .items = 16, .max_read = 16, .max_write = 0},
    {.name = "Q",
     .item_bits = 8,
     .items = 16,
     .writable = true,
     .max_read = 16,
     .max_write = 16,
     .bit_write = true},
    {.name = "S", .item_bits = 8, .items = 32, .max_read = 32, .max_write = 0},
    {.name = "SM",
     .item_bits = 8,
     .items = 550,
     .writable = true,
     .max_read = kMaxRead,
     .max_write = kMaxWrite,
     .bit_write = true},
    {.name = "AI",
     .item_bits = 16,
     .type = ValueType::kInt16,
     .items = 32,
     .max_read = 32,
     .max_write = 0},
    {.name = "AQ",
     .item_bits = 16,
     .type = ValueType::kInt16,
     .items = 32,
     .writable = true,
     .max_read = 32,
     .max_write = 32},
    {.name = "T",
     .item_bits = 32,
     .type = ValueType::kInt32,
     .items = 256,
     .max_read = kMaxRead / 5,
     .max_write = 0},
    {.name = "C",
     .item_bits = 16,
     .type = ValueType::kInt16,
     .items = 256,
     .max_read = kMaxRead / 3,
     .max_write = 0},
    {.name = "HC",
     .item_bits = 32,
     .type = ValueType::kInt32,
     .items = 6,
     .max_read = 6,
     .max_write = 0},
}};
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

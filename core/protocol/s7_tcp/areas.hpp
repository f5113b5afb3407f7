// The memory of the S7-300, 400, 1200 and 1500, and its notation.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/protocol/s7comm/memory.hpp"

namespace fieldcast::s7_tcp {

enum : AreaIndex { kDB, kM, kI, kQ, kPI, kT, kC, kAreaCount };

using Areas = std::array<Area, kAreaCount>;

inline constexpr std::array<s7comm::AreaCode, kAreaCount> kCodes{{
    {.code = 0x84, .blocks = true},
    {.code = 0x83},
    {.code = 0x81},
    {.code = 0x82},
    {.code = 0x80},
    {.code = 0x1D, .transport = 0x1D, .item_size = 2, .counted = true},
    {.code = 0x1C, .transport = 0x1C, .item_size = 2, .counted = true},
}};

// Sizes of the largest CPUs. A smaller CPU refuses the rest.
constexpr Areas areas_of(std::size_t pdu) {
  const auto read = static_cast<std::uint16_t>(pdu - s7comm::kReadOverhead);
  const auto write = static_cast<std::uint16_t>(pdu - s7comm::kWriteOverhead);
  const auto bytes = [&](std::string_view name, std::uint32_t items, bool writable) {
    return Area{.name = name,
                .item_bits = 8,
                .items = items,
                .writable = writable,
                .max_read = read,
                .max_write = writable ? write : std::uint16_t{0},
                .bit_write = writable};
  };
  const auto numbers = [&](std::string_view name) {
    return Area{.name = name,
                .items = 2048,
                .max_read = static_cast<std::uint16_t>(read / 2),
                .max_write = 0};
  };
  Area blocks = bytes("DB", s7comm::kBlocks * s7comm::kBlockBytes, true);
  blocks.bank = s7comm::kBlockBytes;
  return {blocks,
          bytes("M", 16384, true),
          bytes("I", 32768, false),
          bytes("Q", 32768, true),
          bytes("PI", 32768, false),
          numbers("T"),
          numbers("C")};
}

// "DB10.DBW20", "DB10.DBX20.3", "DB10.DBS20", "DB10.DTL20", "MB4", "M4.1", "IW0", "PIW752", "T5",
// "C5".
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(std::span<const Area> areas,
                                                                      std::string_view at);

}  // namespace fieldcast::s7_tcp

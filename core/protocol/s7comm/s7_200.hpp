// The memory of the CPUs of the S7-200 family, and its notation.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "core/protocol/s7comm/memory.hpp"

namespace fieldcast::s7comm {

enum : AreaIndex { kV, kM, kI, kQ, kS, kSM, kAI, kAQ, kT, kC, kHC, kS7200Areas };

using AreaSizes = std::array<std::uint32_t, kS7200Areas>;
using S7200Areas = std::array<Area, kS7200Areas>;

// CPU 226. A smaller CPU refuses the rest.
inline constexpr AreaSizes kS7226{10240, 32, 16, 16, 32, 550, 32, 32, 256, 256, 6};
// CPU ST60 of the S7-200 SMART; V also contains the process image of a LOGO!.
inline constexpr AreaSizes kS7200Smart{20480, 32, 32, 32, 32, 1536, 56, 56, 256, 256, 6};

inline constexpr std::array<AreaCode, kS7200Areas> kS7200Codes{{
    {.code = 0x84, .block = 1},
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

// Only forcing writes I.
constexpr S7200Areas s7_200_areas(const AreaSizes& sizes, std::size_t pdu) {
  const auto bytes = [&](AreaIndex area, std::string_view name, bool writable) {
    const auto most = [&](std::size_t overhead) {
      return static_cast<std::uint16_t>(std::min<std::size_t>(sizes[area], pdu - overhead));
    };
    return Area{.name = name,
                .item_bits = 8,
                .items = sizes[area],
                .writable = writable,
                .max_read = most(kReadOverhead),
                .max_write = writable ? most(kWriteOverhead) : std::uint16_t{0},
                .bit_write = writable};
  };
  const auto numbers = [&](AreaIndex area, std::string_view name, ValueType type,
                           bool writable = false) {
    const std::size_t fit = (pdu - kReadOverhead) / kS7200Codes[area].item_size;
    const auto most = static_cast<std::uint16_t>(std::min<std::size_t>(sizes[area], fit));
    return Area{.name = name,
                .item_bits = type == ValueType::kInt32 ? 32u : 16u,
                .type = type,
                .items = sizes[area],
                .writable = writable,
                .max_read = most,
                .max_write = writable ? most : std::uint16_t{0}};
  };
  return {bytes(kV, "V", true),
          bytes(kM, "M", true),
          bytes(kI, "I", false),
          bytes(kQ, "Q", true),
          bytes(kS, "S", false),
          bytes(kSM, "SM", true),
          numbers(kAI, "AI", ValueType::kInt16),
          numbers(kAQ, "AQ", ValueType::kInt16, true),
          numbers(kT, "T", ValueType::kInt32),
          numbers(kC, "C", ValueType::kInt16),
          numbers(kHC, "HC", ValueType::kInt32)};
}

inline constexpr S7200Areas kS7226Areas = s7_200_areas(kS7226, kSmallestPdu);
inline constexpr Memory kS7226Memory{kS7226Areas, kS7200Codes};

// "VB100", "VW100", "VD204", "V10.3", "I0.3", "SMB28", "AIW4", "T37", "C5", "HC0".
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_s7_200_address(
    std::span<const Area> areas, std::string_view at);

inline constexpr std::string_view kS7200Addresses[] = {
    "VB100", "VW102", "VD104", "V108.3", "MB1",  "MW2",  "MD4", "M9.7", "IB0", "IW2",
    "ID4",   "I9.3",  "QB0",   "QW2",    "QD4",  "Q9.0", "SB0", "SW2",  "SD4", "S9.1",
    "SMB28", "SMW30", "SMD34", "SM0.1",  "AIW4", "AQW2", "T37", "C5",   "HC0"};

}  // namespace fieldcast::s7comm

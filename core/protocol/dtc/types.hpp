// Each type is an area with its own 65536 variables, in the order of the numbers on the wire.
#pragma once

#include <array>

#include "core/protocol/protocol.hpp"

namespace fieldcast::dtc {

enum Type : AreaIndex { kBit, kInt16, kInt32, kFloat32, kFloat64, kTypeCount };
inline constexpr std::array<std::string_view, kTypeCount> kTypeNames{"bit", "int16", "int32",
                                                                     "float32", "float64"};
inline constexpr std::array<unsigned, kTypeCount> kTypeBits{1, 16, 32, 32, 64};
inline constexpr std::array<ValueType, kTypeCount> kValueTypes{
    ValueType::kBool, ValueType::kInt16, ValueType::kInt32, ValueType::kFloat32,
    ValueType::kFloat64};
inline constexpr std::uint32_t kVariables = 65536;  // of each type

// Bits are packed and padded to a byte. REQUIRES: type < kTypeCount.
[[nodiscard]] constexpr std::size_t data_bytes(AreaIndex type, std::uint32_t count) {
  return (std::size_t{count} * kTypeBits[type] + 7) / 8;
}

// "int16:100", "bit:7", "float32:12"; "int16:100.3" for a bit of an integer.
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at);

}  // namespace fieldcast::dtc

// Each type is an area with its own 65536 variables, in the order of the numbers on the wire.
#pragma once

#include <array>
#include <optional>

#include "core/base/bytes.hpp"
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

// Messages of DTC.
//
//     request   address(1) command(1) group.. CRC(2)
//     group     first(2) type(1) count(2) [data, in a write]
//     response  address(1) command(1) data.. CRC(2)     data of all groups in request order;
//                                                       none in the response to a write
//     refusal   address(1) command|80 code(1) CRC(2)
//
// Numbers are big-endian, bits are packed from the least significant. The CRC is that of Modbus,
// low byte first.
inline constexpr std::uint8_t kRead = 0x00, kWrite = 0x01, kRefused = 0x80;
inline constexpr std::size_t kMessageHead = 2, kCrcBytes = 2, kGroupHead = 5, kRefusalSize = 5;

struct MessageSizes {
  std::size_t request = 0;
  std::size_t response = 0;
};
// Empty if a limit is exceeded, or a message would be longer than `longest`. Does not allocate.
[[nodiscard]] std::optional<MessageSizes> message_sizes(const Request& request,
                                                        std::size_t longest);

// REQUIRES: message_sizes(request) holds a value.
[[nodiscard]] Bytes message_of(std::uint8_t address, const Request& request);

// REQUIRES: `data` has the size given by message_sizes().response.
[[nodiscard]] Reply reply_of(const Request& request, ByteView data);

inline constexpr std::array kRefusals{
    DeviceCode{1, "unknown command"}, DeviceCode{2, "address out of range"},
    DeviceCode{3, "unknown type"},    DeviceCode{4, "too long, or a group is cut off"},
    DeviceCode{5, "count 0"},
};
[[nodiscard]] std::string_view refusal_text(std::uint8_t code);  // "address out of range"

// Size of the group of a request at the start of the bytes; 0 if it is incomplete.
[[nodiscard]] std::size_t group_size(ByteView bytes, bool with_data);

// REQUIRES: group_size() found one.
[[nodiscard]] bool inside(ByteView group);

// Returns true if existing groups fill the bytes exactly, which rarely happens in a read response.
[[nodiscard]] bool all_groups(ByteView bytes, bool with_data);

}  // namespace fieldcast::dtc

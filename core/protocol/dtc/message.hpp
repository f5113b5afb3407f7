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
#pragma once

#include <array>
#include <optional>

#include "core/protocol/protocol.hpp"

namespace fieldcast::dtc {

inline constexpr std::uint8_t kRead = 0x00, kWrite = 0x01, kRefused = 0x80;
inline constexpr std::size_t kMessageHead = 2, kCrcBytes = 2, kGroupHead = 5, kRefusalSize = 5;

struct MessageSizes {
  std::size_t request = 0;
  std::size_t answer = 0;
};
// Empty if a limit is exceeded, or a message would be longer than `longest`. Does not allocate.
[[nodiscard]] std::optional<MessageSizes> message_sizes(const Request& request,
                                                        std::size_t longest);

// REQUIRES: message_sizes(request) holds a value.
[[nodiscard]] Bytes message_of(std::uint8_t address, const Request& request);

// REQUIRES: message.size() > kCrcBytes.
[[nodiscard]] bool crc_is_right(ByteView message);

// REQUIRES: `data` has the size given by message_sizes().answer.
[[nodiscard]] Reply reply_of(const Request& request, ByteView data);

inline constexpr std::array kRefusals{
    DeviceCode{1, "unknown command"}, DeviceCode{2, "address out of range"},
    DeviceCode{3, "unknown type"},    DeviceCode{4, "too long, or a group is cut off"},
    DeviceCode{5, "count 0"},
};
[[nodiscard]] std::string_view refusal_text(std::uint8_t code);  // "address out of range"

}  // namespace fieldcast::dtc

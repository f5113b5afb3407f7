// S7 messages: reads and writes of memory.
//
//     request          32 01 00 00 ref(2) plen(2) dlen(2), then one of
//       read           04 n item*n
//       write          05 01 item, then 00 TS len(2) data
//     item             12 0A 10 TS count(2) db(2) area address(3)
//     response         32 03 00 00 ref(2) plen(2) dlen(2) class code, then one of
//       to a read      04 n, then n times: code TS len(2) data
//       to a write     05 01, then a code
//
// address: byte * 8 + bit, or the number of a timer or counter. Code FF means success. len counts
// bits with TS 04, items with 03, bytes with 09; every item of a response but the last is filled to
// an even number of bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/s7comm/memory.hpp"

namespace fieldcast::s7comm {

inline constexpr std::size_t kMaxItems = 20;  // as Siemens allows; 240 bytes hold only 19

struct MessageSizes {
  std::size_t request = 0;
  std::size_t response = 0;
};
// Empty if a limit is exceeded. Does not allocate.
[[nodiscard]] std::optional<MessageSizes> message_sizes(const Memory& memory,
                                                        const Request& request);

// REQUIRES: message_sizes(memory, request) holds a value.
[[nodiscard]] Bytes message_of(const Memory& memory, const Request& request,
                               std::uint16_t reference);

struct Judgement {
  enum class Kind : std::uint8_t { kResponse, kRefused, kMalformed, kForeign };
  Kind kind = Kind::kMalformed;
  std::uint16_t code = 0;  // kRefused: class and code of the header, or the code of the only item
  Reply reply;             // for kResponse
};
[[nodiscard]] Judgement judge(ByteView message, const Memory& memory, const Request& request,
                              std::uint16_t reference);

// Return codes of items and of the link, then class and code of a message's header.
inline constexpr std::array kErrorCodes{
    DeviceCode{0x01, "hardware fault", Cause::kDeviceBusy, true},
    DeviceCode{0x02, "no resource", Cause::kDeviceBusy},  // of the link, as 09
    DeviceCode{0x03, "object not accessible"},
    DeviceCode{0x05, "address out of range"},
    DeviceCode{0x06, "data type not supported"},
    DeviceCode{0x07, "size does not match"},
    DeviceCode{0x09, "no data yet", Cause::kDeviceBusy},
    DeviceCode{0x0A, "object does not exist"},
    DeviceCode{0x8001, "wrong position of the mode switch", Cause::kDeviceBusy},
    DeviceCode{0x8100, "syntax, size or function not supported"},
    DeviceCode{0x8404, "busy", Cause::kDeviceBusy},
    DeviceCode{0x8500, "wrong length"},
    DeviceCode{0xD200, "refused by the protection of the CPU"},
    DeviceCode{0xD600, "password missing or wrong"},
    DeviceCode{0xDC01, "clock value out of range"},
};
[[nodiscard]] std::string_view item_code_text(std::uint8_t code);  // "address out of range"

}  // namespace fieldcast::s7comm

// The S7 unit inside a data telegram: reads and writes of memory.
//
//     request   32 01 00 00 ref(2) plen(2) dlen(2)            04 n item*n           or   05 01 item, then 00 TS len(2) data
//     item      12 0A 10 TS count(2) db(2) area address(3)    address = byte * 8 + bit, or the number of a timer or counter
//     answer    32 03 00 00 ref(2) plen(2) dlen(2) class code 04 n, then n times code TS len(2) data   or   05 01, then a code
//
// Code FF is good. len counts bits with TS 04, items with 03, bytes with 09; every item of an answer but the last is filled to an
// even number of bytes.
#pragma once

#include <optional>

#include "core/protocol/protocol.hpp"
#include "core/protocol/s7_ppi/areas.hpp"

namespace fieldcast::s7_ppi {

inline constexpr std::size_t kMaxItems = 19;  // twenty by Siemens' rule, but 240 bytes hold no more

struct UnitSizes {
  std::size_t request = 0;
  std::size_t answer = 0;
};
// Nothing when a limit is broken. Allocates nothing.
[[nodiscard]] std::optional<UnitSizes> unit_sizes(const Request& request);

// REQUIRES: unit_sizes(request) holds a value.
[[nodiscard]] Bytes unit_of(const Request& request, std::uint16_t reference);

// What an answer's unit says to a request.
struct Judgement {
  enum class Kind : std::uint8_t { kAnswer, kRefused, kMalformed, kForeign };
  Kind kind = Kind::kMalformed;
  std::uint16_t code = 0;  // kRefused: class and code of the header, or the code of the only item
  Reply reply;             // kAnswer
};
[[nodiscard]] Judgement judge_unit(ByteView unit, const Request& request, std::uint16_t reference);

[[nodiscard]] std::string_view item_code_text(std::uint8_t code);  // "address out of range"

}  // namespace fieldcast::s7_ppi

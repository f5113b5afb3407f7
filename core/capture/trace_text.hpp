// Parses a pasted line of the wire trace, from a terminal or from a journal with date, machine and
// process before it. Pure, any thread.
//
//   2026-11-22T14:24:21.126358Z press-shop >> 01 03 00 64 00 02 85 D4
#pragma once

#include <optional>
#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast {

struct TraceText {
  std::string_view time;  // as written; empty if missing
  std::string_view bus;   // as written; empty if missing
  enum class Mark : std::uint8_t { kSent, kReceived, kRemark } mark = Mark::kRemark;
  Bytes bytes;            // of kSent and kReceived
  std::string_view text;  // of a remark
};

// Empty if the line has no mark, or the text after it is not hexadecimal.
[[nodiscard]] std::optional<TraceText> parse_trace_text(std::string_view line);

}  // namespace fieldcast

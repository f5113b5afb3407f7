// Reads a text line of the wire trace as it was pasted: from a terminal, or from a journal that put
// date, machine and process before it.
//
//   2026-11-22T14:24:21.126358Z press-shop >> 01 03 00 64 00 02 85 D4
//
// Pure, any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast {

struct TraceText {
  std::string_view time;  // as written; empty: none stands there
  std::string_view bus;   // the same
  enum class Mark : std::uint8_t { kSent, kReceived, kRemark } mark = Mark::kRemark;
  Bytes bytes;            // of the first two
  std::string_view text;  // of a remark
};

// Nothing: the text line has no mark, or what stands behind it is no hexadecimal.
[[nodiscard]] std::optional<TraceText> parse_trace_text(std::string_view line);

}  // namespace fieldcast

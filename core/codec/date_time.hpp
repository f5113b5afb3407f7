// Dates with a time of Siemens S7 CPUs, as text of ISO 8601 without a zone, because the CPU stores
// none: "2026-11-28T10:15:00.000000000". Pure functions.
//
//     DTL            year(2) month day weekday hour minute second nanosecond(4)
//     DATE_AND_TIME  year month day hour minute second millisecond(1.5) weekday(0.5)    in BCD
//
// Years are 1970 to 2554 (S7-1200 System Manual, A5E02486680-AK, tables 5-33 and 5-34) and 1990 to
// 2089 (Programming with STEP 7, A5E02789666-01, 27.3.3.2). Sunday is weekday 1; the weekday is
// written, and not checked when read.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/codec/text_codec.hpp"

namespace fieldcast {

// REQUIRES: is_date_time(layout).
[[nodiscard]] constexpr unsigned date_time_bytes(TextLayout layout) {
  return layout == TextLayout::kDtl ? 12 : 8;
}

// Fails with kRange if it is no date or no time of day.
// REQUIRES: is_date_time(layout), date_time_bytes(layout) bytes.
[[nodiscard]] tl::expected<std::string, Cause> read_date_time(TextLayout layout, ByteView bytes);

// The fraction of the second may be shorter, or absent. Fails with kRange if the text has another
// form, or names no date and time that the layout can hold. REQUIRES: is_date_time(layout).
[[nodiscard]] tl::expected<Bytes, Cause> write_date_time(TextLayout layout, std::string_view text);

}  // namespace fieldcast

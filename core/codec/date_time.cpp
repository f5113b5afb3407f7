#include "core/codec/date_time.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "core/codec/digits.hpp"

namespace fieldcast {
namespace {

constexpr std::string_view kPicture = "0000-00-00T00:00:00.000000000";
constexpr std::size_t kSeconds = 19;  // characters without a fraction
constexpr unsigned kNanosecondDigits = 9, kMillisecondDigits = 3;

struct DateTime {
  unsigned year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  std::uint32_t nanosecond = 0;

  [[nodiscard]] std::chrono::year_month_day date() const {
    return {std::chrono::year(static_cast<int>(year)), std::chrono::month(month),
            std::chrono::day(day)};
  }
  [[nodiscard]] std::uint8_t weekday() const {
    return static_cast<std::uint8_t>(
        std::chrono::weekday(std::chrono::sys_days(date())).c_encoding() + 1);
  }
};

bool holds(TextLayout layout, const DateTime& at) {
  const bool dtl = layout == TextLayout::kDtl;
  return at.year >= (dtl ? 1970 : 1990) && at.year <= (dtl ? 2554 : 2089) && at.date().ok() &&
         at.hour < 24 && at.minute < 60 && at.second < 60 && at.nanosecond < 1'000'000'000;
}

std::uint8_t from_bcd(std::uint8_t byte) {
  return static_cast<std::uint8_t>((byte >> 4) * 10 + (byte & 0xF));
}
std::uint8_t to_bcd(unsigned number) {
  return static_cast<std::uint8_t>(number / 10 % 10 << 4 | number % 10);
}

std::optional<DateTime> parse_dtl(ByteView bytes) {
  return DateTime{read_u16(bytes), bytes[2], bytes[3],          bytes[5],
                  bytes[6],        bytes[7], read_u32(bytes, 8)};
}

std::optional<DateTime> parse_date_and_time(ByteView bytes) {
  if (std::ranges::any_of(bytes, [](auto byte) { return byte >> 4 > 9 || (byte & 0xF) > 9; }))
    return std::nullopt;
  std::array<std::uint8_t, 8> part{};
  std::ranges::transform(bytes.first(8), part.begin(), from_bcd);
  return DateTime{
      part[0] + (part[0] < 90 ? 2000u : 1900u),      part[1], part[2], part[3], part[4], part[5],
      (part[6] * 10u + (bytes[7] >> 4)) * 1'000'000u};
}

std::optional<DateTime> parse_text(TextLayout layout, std::string_view text) {
  if (text.size() < kSeconds || text.size() == kSeconds + 1 ||
      text.size() > date_time_characters(layout))
    return std::nullopt;
  const std::string whole = std::string(text) + std::string(kPicture.substr(text.size()));
  const auto fits = [](char c, char form) {
    return form == '0' ? c >= '0' && c <= '9' : c == form;
  };
  if (!std::ranges::equal(whole, kPicture, fits)) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t digits) {
    return static_cast<unsigned>(std::stoul(whole.substr(at, digits)));
  };
  return DateTime{number(0, 4),
                  number(5, 2),
                  number(8, 2),
                  number(11, 2),
                  number(14, 2),
                  number(17, 2),
                  number(20, kNanosecondDigits)};
}

}  // namespace

tl::expected<std::string, Cause> read_date_time(TextLayout layout, ByteView bytes) {
  const bool dtl = layout == TextLayout::kDtl;
  const auto at = dtl ? parse_dtl(bytes) : parse_date_and_time(bytes);
  if (!at || !holds(layout, *at)) return tl::unexpected(Cause::kRange);
  Bytes text;
  const auto put = [&](char mark, std::uint32_t number, unsigned digits) {
    if (mark != '\0') text.push_back(static_cast<std::uint8_t>(mark));
    append_digits(text, number, digits, 10);
  };
  put('\0', at->year, 4);
  put('-', at->month, 2);
  put('-', at->day, 2);
  put('T', at->hour, 2);
  put(':', at->minute, 2);
  put(':', at->second, 2);
  put('.', dtl ? at->nanosecond : at->nanosecond / 1'000'000,
      dtl ? kNanosecondDigits : kMillisecondDigits);
  return std::string(text.begin(), text.end());
}

tl::expected<Bytes, Cause> write_date_time(TextLayout layout, std::string_view text) {
  const auto at = parse_text(layout, text);
  if (!at || !holds(layout, *at)) return tl::unexpected(Cause::kRange);
  Bytes bytes;
  if (layout == TextLayout::kDtl) {
    append_u16(bytes, static_cast<std::uint16_t>(at->year));
    for (const unsigned part :
         {at->month, at->day, unsigned{at->weekday()}, at->hour, at->minute, at->second})
      bytes.push_back(static_cast<std::uint8_t>(part));
    append_u32(bytes, at->nanosecond);
    return bytes;
  }
  const std::uint32_t milliseconds = at->nanosecond / 1'000'000;
  for (const unsigned part : {at->year, at->month, at->day, at->hour, at->minute, at->second,
                              milliseconds / 10, milliseconds % 10 * 10 + at->weekday()})
    bytes.push_back(to_bcd(part));
  return bytes;
}

}  // namespace fieldcast

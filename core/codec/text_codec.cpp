#include "core/codec/text_codec.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/message_text.hpp"

namespace fieldcast {

namespace {

bool is_ascii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// A byte of Latin-1 is the code point of its character; 80..9F are controls.
std::string latin1_to_utf8(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0xA0) {
      text += escaped({&c, 1});
    } else {
      text += static_cast<char>(0xC0u | byte >> 6);
      text += static_cast<char>(0x80u | (byte & 0x3Fu));
    }
  }
  return text;
}

std::optional<std::string> latin1_from_utf8(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (length == 0 || length > 2 || (length == 2 && first > 0xC3)) return std::nullopt;
    bytes += length == 1 ? text[0]
                         : static_cast<char>((first & 0x03u) << 6 |
                                             (static_cast<unsigned char>(text[1]) & 0x3Fu));
    text.remove_prefix(length);
  }
  return bytes;
}

class PlainTextCodec final : public TextCodec {
 public:
  std::string to_utf8(Charset charset, std::string_view bytes) override {
    if (charset == Charset::kUtf8) return escaped(bytes);
    if (charset == Charset::kLatin1) return latin1_to_utf8(bytes);
    std::string text;
    // Byte by byte, so that it is never treated as UTF-8.
    for (const char& c : bytes) text += escaped({&c, 1});
    return text;
  }
  std::optional<std::string> from_utf8(Charset charset, std::string_view text) override {
    if (charset == Charset::kLatin1) return latin1_from_utf8(text);
    const bool fits = charset == Charset::kUtf8 ? is_utf8(text) : is_ascii(text);
    return fits ? std::optional<std::string>(text) : std::nullopt;
  }
};

}  // namespace

std::string_view to_text(Charset charset) {
  switch (charset) {
    case Charset::kUtf8: return "utf-8";
    case Charset::kLatin1: return "latin-1";
    case Charset::kGbk: return "gbk";
    case Charset::kShiftJis: return "shift-jis";
  }
  return "?";
}

TextCodec& plain_text_codec() {
  static PlainTextCodec codec;
  return codec;
}

namespace {

constexpr std::uint64_t kLowestMagnitude = std::uint64_t{1} << 63;  // of the lowest int64
constexpr std::size_t kMaxCharacters = 64;  // of a number; longer texts are rejected

using Read = tl::expected<Value, Cause>;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
// Padding used by devices.
bool blank(char c) { return c == ' ' || c == '\t' || c == '\0'; }

std::string_view without_padding(std::string_view text) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

char mark_of(TextNumber::Kind kind) { return kind == TextNumber::Kind::kDecimalComma ? ',' : '.'; }

Read whole_number(std::string_view digits, bool negative) {
  std::uint64_t magnitude = 0;
  const auto error = std::from_chars(digits.data(), digits.data() + digits.size(), magnitude).ec;
  if (error != std::errc{} || (negative && magnitude > kLowestMagnitude))
    return tl::unexpected(Cause::kRange);
  if (!negative)
    return magnitude < kLowestMagnitude ? Value{static_cast<std::int64_t>(magnitude)}
                                        : Value{magnitude};
  return Value{magnitude == kLowestMagnitude ? std::numeric_limits<std::int64_t>::min()
                                             : -static_cast<std::int64_t>(magnitude)};
}

std::string digits_of(const Value& number, bool single, int decimals) {
  std::array<char, 400> buffer{};  // the largest double has 309 digits before the point
  char* const first = buffer.data();
  char* const last = first + buffer.size();
  std::to_chars_result end{};
  if (const auto* i = std::get_if<std::int64_t>(&number)) {
    end = std::to_chars(first, last, *i < 0 ? 0 - static_cast<std::uint64_t>(*i) : *i + 0ULL);
  } else if (const auto* u = std::get_if<std::uint64_t>(&number)) {
    end = std::to_chars(first, last, *u);
  } else {
    const double magnitude = std::abs(std::get<double>(number));
    end = decimals >= 0 ? std::to_chars(first, last, magnitude, std::chars_format::fixed, decimals)
          : single
              ? std::to_chars(first, last, static_cast<float>(magnitude), std::chars_format::fixed)
              : std::to_chars(first, last, magnitude, std::chars_format::fixed);
  }
  std::string text(first, end.ptr);
  if (decimals > 0 && text.find('.') == text.npos)
    text.append(1, '.').append(static_cast<std::size_t>(decimals), '0');
  return text;
}

bool nothing_left(std::string_view digits) {
  return digits.find_first_of("123456789") == digits.npos;
}

}  // namespace

std::optional<TextNumber> text_number_from_picture(std::string_view picture) {
  TextNumber form{.kind = TextNumber::Kind::kDecimal, .decimals = 0, .leading_zeros = true};
  if (picture.starts_with('+')) form.plus = true, picture.remove_prefix(1);
  const auto mark = picture.find_first_of(".,");
  const auto zeros = [](std::string_view part) {
    return !part.empty() && part.size() <= 32 && part.find_first_not_of('0') == part.npos;
  };
  if (!zeros(picture.substr(0, mark))) return std::nullopt;
  if (mark == picture.npos) return form;
  const auto fraction = picture.substr(mark + 1);
  if (!zeros(fraction)) return std::nullopt;
  if (picture[mark] == ',') form.kind = TextNumber::Kind::kDecimalComma;
  form.decimals = static_cast<std::int8_t>(fraction.size());
  return form;
}

tl::expected<Value, Cause> read_decimal(TextNumber::Kind kind, std::string_view characters) {
  std::string_view text = without_padding(characters);
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text = without_padding(text.substr(1));
  std::array<char, kMaxCharacters> plain{};  // with a point, as from_chars requires
  if (text.empty() || text.size() > plain.size()) return tl::unexpected(Cause::kRange);
  std::size_t at = 0;
  bool digits = false, mark = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == mark_of(kind) && !mark)); ++at) {
    digits = digits || is_digit(text[at]);
    mark = mark || !is_digit(text[at]);
    plain[at] = is_digit(text[at]) ? text[at] : '.';
  }
  if (!digits) return tl::unexpected(Cause::kRange);
  if (at == text.size() && !mark) return whole_number(text, negative);
  if (at != text.size() && text[at] != 'e' && text[at] != 'E') return tl::unexpected(Cause::kRange);
  for (std::size_t i = at; i < text.size(); ++i) plain[i] = text[i];
  double number = 0;
  const char* first = plain.data();
  const auto [end, error] = std::from_chars(first, first + text.size(), number);
  if (error != std::errc{} || end != first + text.size() || !std::isfinite(number))
    return tl::unexpected(Cause::kRange);
  return Value{negative ? -number : number};
}

std::optional<std::uint64_t> read_hex(std::string_view characters) {
  std::string_view text = without_padding(characters);
  if (text.starts_with("0x") || text.starts_with("0X"))
    text.remove_prefix(2);
  else if (text.ends_with('h') || text.ends_with('H'))
    text.remove_suffix(1);
  std::uint64_t bits = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bits, 16);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return bits;
}

tl::expected<std::string, Cause> write_decimal(const TextNumber& form, std::size_t width,
                                               const Value& number, bool single) {
  const auto* i = std::get_if<std::int64_t>(&number);
  const auto* d = std::get_if<double>(&number);
  std::string digits = digits_of(number, single, form.decimals);
  const bool zero =
      (i != nullptr && *i == 0) || (d != nullptr && *d == 0.0) || number == Value{std::uint64_t{0}};
  const bool minus = (i != nullptr && *i < 0) || (d != nullptr && *d < 0);
  const std::size_t room = width - (minus || form.plus ? 1 : 0);
  if (width == 0) return tl::unexpected(Cause::kRange);
  if (digits.size() > room && form.decimals < 0) {
    const auto point = digits.find('.');
    if (point == digits.npos || point > room) return tl::unexpected(Cause::kRange);
    const auto decimals = room > point + 1 ? static_cast<int>(room - point - 1) : 0;
    digits = digits_of(number, single, decimals);
    if (digits.size() > room && decimals > 0)  // rounding added a digit: "99.96"
      digits = digits_of(number, single, decimals - 1);
  }
  if (digits.size() > room) return tl::unexpected(Cause::kRange);
  if (nothing_left(digits) && !zero && form.decimals < 0) return tl::unexpected(Cause::kRange);
  std::replace(digits.begin(), digits.end(), '.', mark_of(form.kind));
  std::string sign = minus && !nothing_left(digits) ? "-" : form.plus ? "+" : "";
  const std::string fill(width - sign.size() - digits.size(), form.leading_zeros ? '0' : ' ');
  return form.leading_zeros ? sign + fill + digits : fill + sign + digits;
}

tl::expected<std::string, Cause> write_hex(std::size_t width, std::uint64_t bits) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text(width, '0');
  for (std::size_t at = width; at-- > 0; bits >>= 4) text[at] = kDigits[bits & 0xF];
  if (bits != 0) return tl::unexpected(Cause::kRange);
  return text;
}

}  // namespace fieldcast

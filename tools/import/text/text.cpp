#include "tools/import/text/text.hpp"

#include <algorithm>
#include <array>
#include <boost/locale/utf.hpp>
#include <charconv>
#include <cmath>
#include <iterator>

#include "core/base/message_text.hpp"

namespace fieldcast::importing {

namespace {

std::optional<std::uint64_t> digits_from(std::string_view text, int base) {
  std::uint64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (fault != std::errc{} || text.empty() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<double> number_from(std::string_view text) {
  text = trimmed(text);
  if (const auto hex =
          text.starts_with("0x") || text.starts_with("0X") ? whole_from(text) : std::nullopt)
    return static_cast<double>(*hex);
  std::string plain(text);
  if (plain.find('.') == std::string::npos) {
    const std::size_t comma = plain.find(',');
    if (comma != std::string::npos) plain[comma] = '.';
  }
  if (plain.starts_with('+')) plain.erase(0, 1);
  double number = 0;
  const auto [end, fault] = std::from_chars(plain.data(), plain.data() + plain.size(), number);
  if (fault != std::errc{} || plain.empty() || end != plain.data() + plain.size() ||
      !std::isfinite(number))
    return std::nullopt;
  return number;
}

std::optional<std::uint64_t> whole_from(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with("0x") || text.starts_with("0X")) return digits_from(text.substr(2), 16);
  if (text.starts_with('$')) return digits_from(text.substr(1), 16);
  if (text.ends_with('h') || text.ends_with('H'))
    return digits_from(text.substr(0, text.size() - 1), 16);
  // A spreadsheet may have added decimals.
  for (const char point : {'.', ','}) {
    const std::size_t at = text.find(point);
    if (at != std::string_view::npos && at > 0 &&
        text.find_first_not_of('0', at + 1) == std::string_view::npos)
      text = text.substr(0, at);
  }
  return digits_from(text, 10);
}

std::optional<Duration> milliseconds_from(std::string_view text, double least, double most) {
  const auto number = number_from(text);
  if (!number || *number < least || *number >= most) return std::nullopt;
  return std::chrono::microseconds{static_cast<std::int64_t>(*number * 1000)};
}

namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  boost::locale::utf::utf_traits<char>::encode(code, std::back_inserter(text));
}

// Windows-1252 characters 0x80 to 0x9F; 0: unassigned.
constexpr std::array<std::uint16_t, 32> kWindows{
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

std::string from_windows(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 8);
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    const bool own = byte >= 0x80 && byte < 0xA0;
    append_utf8(text, own && kWindows[byte - 0x80] != 0 ? kWindows[byte - 0x80] : byte);
  }
  return text;
}

std::string from_utf16(std::string_view bytes, bool big) {
  std::string text;
  text.reserve(bytes.size());
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const auto second = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<std::uint32_t>(big ? first << 8 | second : second << 8 | first);
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    const bool high = code >= 0xD800 && code < 0xDC00;
    if (high && i + 3 < bytes.size() && unit(i + 2) >= 0xDC00 && unit(i + 2) < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (unit(i + 2) - 0xDC00);
      i += 2;
    } else if (code >= 0xD800 && code < 0xE000) {
      code = 0xFFFD;
    }
    append_utf8(text, code);
  }
  return text;
}

// UTF-16 without a byte order mark: in ASCII text every second byte is zero.
bool looks_like_utf16(std::string_view bytes, bool big) {
  const std::size_t units = std::min<std::size_t>(bytes.size() / 2, 200);
  if (units < 8) return false;
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < units; ++i) {
    zeros += bytes[2 * i + (big ? 0 : 1)] == 0;
    if (bytes[2 * i + (big ? 1 : 0)] == 0) return false;
  }
  return zeros * 10 > units * 8;
}

void unify_line_ends(std::string& text) {
  std::string whole;
  whole.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\r') {
      whole += text[i];
    } else if (i + 1 == text.size() || text[i + 1] != '\n') {
      whole += '\n';
    }
  }
  text = std::move(whole);
}

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 && c != '\n' && c != '\r' && c != '\t' && c != '\f';
}
bool has_control(std::string_view text) { return std::ranges::any_of(text, is_control); }

constexpr std::ptrdiff_t kFewControls = 10;

std::optional<std::string> few_controls(std::string_view text) {
  if (std::ranges::count_if(text, is_control) > kFewControls) return std::nullopt;
  const auto first = std::ranges::find_if(text, is_control);
  return fmt::format("line {}: the character 0x{:02X}, which no list has: delete it",
                     std::count(text.begin(), first, '\n') + 1, static_cast<unsigned char>(*first));
}

constexpr std::string_view kBinary = "binary, no text";

std::string_view what_it_is(std::string_view bytes) {
  constexpr std::pair<std::string_view, std::string_view> kKinds[] = {
      {"\x7F\x45LF", "a program, no list"},
      {"\xD0\xCF\x11\xE0", "an old Excel file (.xls); save it as .xlsx or CSV"},
      {"%PDF", "a PDF; copy its table into a spreadsheet and save that as CSV"},
      {"\x89PNG", "a picture, no list"},
      {"\xFF\xD8\xFF", "a picture, no list"},
      {"\x1F\x8B", "packed with gzip; unpack it first"},
      {"SQLite format 3", "a database of SQLite; export the tags as a list"}};
  for (const auto& [begin, kind] : kKinds) {
    if (bytes.starts_with(begin)) return kind;
  }
  return kBinary;
}

}  // namespace

Result<Decoded> decode_text(std::string_view bytes) {
  Decoded decoded;
  if (bytes.starts_with("\xEF\xBB\xBF") && is_utf8(bytes.substr(3))) {
    decoded = {std::string(bytes.substr(3)), "UTF-8"};
  } else if (bytes.starts_with("\xFF\xFE") || looks_like_utf16(bytes, false)) {
    decoded = {from_utf16(bytes.substr(bytes[0] == '\xFF' ? 2 : 0), false), "UTF-16"};
  } else if (bytes.starts_with("\xFE\xFF") || looks_like_utf16(bytes, true)) {
    decoded = {from_utf16(bytes.substr(bytes[0] == '\xFE' ? 2 : 0), true), "UTF-16"};
  } else if (is_utf8(bytes)) {
    decoded = {std::string(bytes), "UTF-8"};
  } else if (std::ranges::count_if(bytes, is_control) <= kFewControls) {
    decoded = {from_windows(bytes), "Windows-1252"};
  } else {
    return refused("{}", what_it_is(bytes));
  }
  // DOS programs end a text with this byte.
  if (decoded.text.ends_with('\x1A')) decoded.text.pop_back();
  if (has_control(decoded.text)) {
    const std::string_view what = what_it_is(bytes);
    const auto where = what == kBinary ? few_controls(decoded.text) : std::nullopt;
    return tl::unexpected(where.value_or(std::string(what)));
  }
  unify_line_ends(decoded.text);
  return decoded;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\n\f\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}
bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::pair<std::string_view, std::string_view> halves(std::string_view text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  return {text.substr(0, end), text.substr(std::min(end + 1, text.size()))};
}

std::string with_replaced(std::string_view text, std::span<const Replacement> rows) {
  std::string result(text);
  for (const auto& [from, to] : rows) {
    for (std::size_t at = result.find(from); at != std::string::npos;
         at = result.find(from, at + to.size()))
      result.replace(at, from.size(), to);
  }
  return result;
}

bool is_one_of(std::string_view word, std::string_view words) {
  if (word.empty() || word.find(' ') != std::string_view::npos) return false;
  for (std::size_t at = words.find(word); at != std::string_view::npos;
       at = words.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' '))
      return true;
  }
  return false;
}

}  // namespace fieldcast::importing

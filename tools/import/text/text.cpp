#include "tools/import/text/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

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

namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0 | code >> 6);
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    text += static_cast<char>(0xE0 | code >> 12);
    text += static_cast<char>(0x80 | (code >> 6 & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    text += static_cast<char>(0xF0 | code >> 18);
    text += static_cast<char>(0x80 | (code >> 12 & 0x3F));
    text += static_cast<char>(0x80 | (code >> 6 & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  }
}

// Returns 0 for a byte that cannot be the first one.
std::size_t sequence_bytes(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  return first >= 0xF0 && first < 0xF5 ? 4 : 0;
}

bool is_utf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    const auto first = static_cast<unsigned char>(bytes[i]);
    const std::size_t size = sequence_bytes(first);
    if (size == 0 || size > bytes.size() - i) return false;
    for (std::size_t k = 1; k < size; ++k) {
      if ((static_cast<unsigned char>(bytes[i + k]) & 0xC0) != 0x80) return false;
    }
    const auto second = size > 2 ? static_cast<unsigned char>(bytes[i + 1]) : 0x80u;
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
      return false;
    i += size;
  }
  return true;
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

// A text may contain a few control characters by accident.
constexpr std::ptrdiff_t kFewControls = 10;

// Describes the first control character; empty if there are too many.
std::optional<std::string> few_controls(std::string_view text) {
  if (std::ranges::count_if(text, is_control) > kFewControls) return std::nullopt;
  const auto first = std::ranges::find_if(text, is_control);
  return fmt::format("line {}: the character 0x{:02X}, which no list has: delete it",
                     std::count(text.begin(), first, '\n') + 1, static_cast<unsigned char>(*first));
}

constexpr std::string_view kBinary = "binary, no text";

std::string what_it_is(std::string_view bytes) {
  const auto begins = [&](std::string_view with) { return bytes.starts_with(with); };
  if (begins("\x7F"
             "ELF"))
    return "a program, no list";
  if (begins("\xD0\xCF\x11\xE0")) return "an old Excel file (.xls); save it as .xlsx or CSV";
  if (begins("%PDF")) return "a PDF; copy its table into a spreadsheet and save that as CSV";
  if (begins("\x89PNG") || begins("\xFF\xD8\xFF")) return "a picture, no list";
  if (begins("\x1F\x8B")) return "packed with gzip; unpack it first";
  if (begins("SQLite format 3")) return "a database of SQLite; export the tags as a list";
  return std::string(kBinary);
}

}  // namespace

tl::expected<Decoded, std::string> decode_text(std::string_view bytes) {
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
    return tl::unexpected(what_it_is(bytes));
  }
  // DOS programs end a text with this byte.
  if (decoded.text.ends_with('\x1A')) decoded.text.pop_back();
  if (has_control(decoded.text)) {
    const std::string what = what_it_is(bytes);
    const auto where = what == kBinary ? few_controls(decoded.text) : std::nullopt;
    return tl::unexpected(where.value_or(what));
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

bool same_word(std::string_view a, std::string_view b) {
  return a.size() == b.size() && lower(a) == lower(b);
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

}  // namespace fieldcast::importing

#include "tools/import/formats/list/list_address.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMostRegisters = 125;  // of one value

using Parsed = tl::expected<ListAddress, std::string>;
using Notation = AddressNotation;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at))
    text.replace(at, from.size(), to), at += to.size();
}

// Replaces typographic dashes, blanks and dots by ASCII, and range words by two dots.
std::string plain_signs(std::string_view cell) {
  std::string text(cell);
  for (const std::string_view dash : {"\u2010", "\u2011", "\u2012", "\u2013", "\u2014", "\u2212"})
    replace_all(text, dash, "-");
  for (const std::string_view blank : {"\u00A0", "\u202F", "\u2009"}) replace_all(text, blank, " ");
  replace_all(text, "\u2026", "..");
  for (const std::string_view word : {" to ", " TO ", " bis "}) replace_all(text, word, "..");
  return std::string(trimmed(text));
}

// "1,234", "1.000", "40 101", "1'234": groups of three digits after one to three.
bool has_thousands(std::string_view text) {
  const std::size_t first = std::ranges::find_if_not(text, is_digit) - text.begin();
  if (first == 0 || first > 3 || first == text.size()) return false;
  for (std::size_t at = first; at < text.size(); at += 4) {
    if (std::string_view(",.' ").find(text[at]) == std::string_view::npos) return false;
    if (text.size() - at < 4 || !all_digits(text.substr(at + 1, 3))) return false;
    if (text.size() - at > 4 && is_digit(text[at + 4])) return false;
  }
  return true;
}

// One number, optionally with a bit.
Parsed single(std::string_view text, Notation notation) {
  text = trimmed(text);
  ListAddress address;
  const bool marked = text.starts_with("0x") || text.starts_with("0X") || text.starts_with('$') ||
                      (lower(text).ends_with('h') && text.size() > 1 && is_digit(text[0]));
  if (notation.hex && !marked) {
    const auto number = whole_from(fmt::format("0x{}", text));
    if (!number || *number > 0xFFFF)
      return tl::unexpected(fmt::format("'{}' is no hexadecimal address from 0 to FFFF", text));
    address.plain = static_cast<std::uint32_t>(*number);
    return address;
  }
  // A blank is allowed only between letters and a number: "HR 100", not "4 0010".
  for (std::size_t at = text.find(' '); at != std::string_view::npos; at = text.find(' ', at + 1)) {
    if (is_digit(text[at - 1]))
      return tl::unexpected(fmt::format("'{}' is not an address: it contains a blank", text));
  }
  const auto reference = reference_from(text, notation.base);
  const std::string_view digits = text.substr(0, text.find('.'));
  const auto number = whole_from(digits);
  if (number && *number <= 65535) address.plain = static_cast<std::uint32_t>(*number);
  if (!reference && !(address.plain && digits == text)) return tl::unexpected(reference.error());
  address.marked_hex = marked;
  if (reference) {
    address.bit = reference->bit;
    if (reference->area) address.reference = *reference;
  }
  return address;
}

// Distance from the first address to the second.
std::optional<std::int64_t> steps(const ListAddress& first, const ListAddress& second) {
  if (first.plain && second.plain) return std::int64_t{*second.plain} - *first.plain;
  if (!first.reference || !second.reference) return std::nullopt;
  if (first.reference->area != second.reference->area) return std::nullopt;
  return std::int64_t{second.reference->first} - first.reference->first;
}

// "30001/2": the second part has only the last digits.
std::string whole_number(std::string_view first, std::string_view second) {
  if (all_digits(first) && all_digits(second) && second.size() < first.size() && second[0] != '0')
    return fmt::format("{}{}", first.substr(0, first.size() - second.size()), second);
  return std::string(second);
}

Parsed several(std::string_view cell, const std::vector<std::string_view>& parts, bool is_range,
               Notation notation) {
  for (const std::string_view part : parts) {
    if (trimmed(part).empty())
      return tl::unexpected(fmt::format(
          "the range '{}' is open; name its first and its last register: 40003..40004", cell));
  }
  auto first = single(parts.front(), notation);
  if (!first) return tl::unexpected(fmt::format("'{}' is no address", cell));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto next =
        single(notation.hex || is_range ? std::string(parts[i]) : whole_number(parts[0], parts[i]),
               notation);
    const auto far = next ? steps(*first, *next) : std::nullopt;
    const bool right = far && (is_range ? *far >= 0 && *far < kMostRegisters
                                        : *far == static_cast<std::int64_t>(i));
    if (!right || first->bit || next->bit)
      return tl::unexpected(
          fmt::format("'{}' is no address, and no registers one behind the other", cell));
    first->registers = static_cast<unsigned>(*far) + 1;
  }
  return first;
}

// "3-0007" is a reference, "3-4" are two registers.
bool is_reference_with_dash(std::string_view text) {
  return text.size() >= 6 && text[1] == '-' && all_digits(text.substr(2)) &&
         std::string_view("0134").find(text[0]) != std::string_view::npos;
}

Parsed without_remark(std::string_view text, Notation notation) {
  if (has_thousands(text))
    return tl::unexpected(
        fmt::format("'{}' is no address: is it one number with separators, or two?", text));
  if (const std::size_t dots = text.find(".."); dots != std::string_view::npos && dots > 0) {
    const std::size_t last = std::min(text.find_first_not_of('.', dots), text.size());
    return several(text, {text.substr(0, dots), text.substr(last)}, true, notation);
  }
  // "40001,0" of a spreadsheet with decimal commas.
  if (const std::size_t comma = text.find(','); comma != std::string_view::npos) {
    const std::string_view behind = text.substr(comma + 1);
    if (!behind.empty() && behind.find_first_not_of('0') == std::string_view::npos)
      return single(text.substr(0, comma), notation);
  }
  for (const char separator : {'-', '~'}) {
    const std::size_t at = text.find(separator, 1);
    if (at != std::string_view::npos && !is_reference_with_dash(text))
      return several(text, {text.substr(0, at), text.substr(at + 1)}, true, notation);
  }
  for (const char separator : {',', ';', '/', '+'}) {
    if (text.find(separator) != std::string_view::npos)
      return several(text, split(text, separator), false, notation);
  }
  return single(text, notation);
}

// "100 (0x64)", "40001 (0)": the second number must be equal, or counted from 0.
Parsed with_remark(std::string_view cell, std::string_view text, std::string_view remark,
                   Notation notation) {
  auto address = without_remark(trimmed(text), notation);
  if (!address) return address;
  const auto number = whole_from(remark);
  if (number && address->plain && *number == *address->plain) return address;
  if (number && address->reference && *number == address->reference->first) {
    address->plain.reset();
    return address;
  }
  return tl::unexpected(fmt::format("'{}' is no address that is understood", cell));
}

}  // namespace

tl::expected<ListAddress, std::string> list_address_from(std::string_view cell, Notation notation) {
  const std::string whole = plain_signs(cell);
  std::string_view text = whole;
  if (text.empty()) return tl::unexpected(std::string("no address"));
  std::optional<std::uint64_t> bit;
  if (const std::size_t at = lower(text).find("bit"); at != std::string_view::npos && at > 0) {
    bit = whole_from(text.substr(at + 3));
    if (!bit || *bit > 15)
      return tl::unexpected(fmt::format("bit '{}' is not 0 to 15", trimmed(text.substr(at + 3))));
    text = trimmed(text.substr(0, at));
  }
  const std::size_t bracket = text.find('(');
  auto address = bracket != std::string_view::npos && bracket > 0 && text.ends_with(')')
                     ? with_remark(cell, text.substr(0, bracket),
                                   text.substr(bracket + 1, text.size() - bracket - 2), notation)
                     : without_remark(text, notation);
  if (address && bit) {
    if (address->bit || address->registers > 1)
      return tl::unexpected(fmt::format("'{}' is no address of a bit", cell));
    address->bit = static_cast<std::uint8_t>(*bit);
  }
  return address;
}

}  // namespace fieldcast::importing

#include "tools/import/formats/kepware_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMostElements = 1000;

// "DM0100.20H": letters, a number, and a suffix after a dot. "V0100[4]": elements.
struct AddressParts {
  std::string area, digits, suffix;
  unsigned elements = 0;  // 0: not an array

  [[nodiscard]] std::uint64_t number() const { return whole_from(digits).value_or(0); }
};

bool is_area_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_decimal(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::optional<AddressParts> parts_of(std::string_view text) {
  AddressParts parts;
  std::size_t at = 0;
  while (at < text.size() && is_area_letter(text[at]))
    parts.area += static_cast<char>(std::toupper(static_cast<unsigned char>(text[at++])));
  while (at < text.size() && is_decimal(text[at])) parts.digits += text[at++];
  if (parts.area.empty() || parts.digits.empty() || parts.digits.size() > 6) return std::nullopt;
  std::string_view rest = text.substr(at);
  if (rest.starts_with('[')) {
    if (!rest.ends_with(']')) return std::nullopt;
    const auto count = whole_from(rest.substr(1, rest.size() - 2));
    if (!count || *count == 0 || *count > kMostElements) return std::nullopt;
    parts.elements = static_cast<unsigned>(*count);
    return parts;
  }
  if (rest.starts_with('.')) {
    parts.suffix = rest.substr(1);
    rest = {};
  }
  if (!rest.empty()) return std::nullopt;
  return parts;
}

using Made = tl::expected<Point, std::string>;

tl::unexpected<std::string> refused(std::string why) { return tl::unexpected(std::move(why)); }

unsigned width_of(ValueType type) {
  return type == ValueType::kInt8 || type == ValueType::kUint8 || type == ValueType::kBcd8
             ? 8
             : 16 * registers_of(type, 0);
}

// Our address contains the width; in Kepware the type does.
Made s7_point(const AddressParts& parts, Point point) {
  static constexpr std::array<std::string_view, 3> kByNumber{"T", "C", "HC"};
  static constexpr std::array<std::string_view, 2> kWords{"AI", "AQ"};
  const std::uint64_t number = parts.number();
  if (point.type == ValueType::kString) return refused("a text: its length is not known");
  if (std::ranges::find(kByNumber, parts.area) != kByNumber.end()) {
    if (point.type == ValueType::kBool)
      return refused("the status bit of a timer or counter is not read by PPI here");
    point.at = fmt::format("{}{}", parts.area, number);
    return point;
  }
  if (std::ranges::find(kWords, parts.area) != kWords.end()) {
    point.at = fmt::format("{}W{}", parts.area, number);
    return point;
  }
  if (parts.suffix.empty()) {
    if (point.type == ValueType::kBool) return refused("a Boolean without a bit");
    const unsigned bits = width_of(point.type);
    if (bits > 32) return refused("values of 64 bits are not read by PPI");
    point.at = fmt::format("{}{}{}", parts.area, bits == 8 ? "B" : bits == 16 ? "W" : "D", number);
    return point;
  }
  const auto bit = whole_from(parts.suffix);
  if (!bit) return tl::unexpected(fmt::format("'.{}' is no bit", parts.suffix));
  if (*bit > 7)
    return tl::unexpected(
        fmt::format("bit {} of a word or double word: name the byte and a bit from 0 to 7", *bit));
  if (point.type != ValueType::kBool) return refused("a number whose address names a bit");
  point.at = fmt::format("{}{}.{}", parts.area, number, *bit);
  return point;
}

// "20H": the first character is in the high byte; "20L": in the low byte.
Made omron_text(const AddressParts& parts, Point point) {
  const char order = parts.suffix.empty() ? '\0' : parts.suffix.back();
  if (order == 'D' || order == 'd' || order == 'E' || order == 'e')
    return refused("a text with one character in a word");
  const auto bytes =
      order == 'H' || order == 'h' || order == 'L' || order == 'l'
          ? whole_from(std::string_view(parts.suffix).substr(0, parts.suffix.size() - 1))
          : std::nullopt;
  if (!bytes || *bytes == 0 || *bytes > kMaxStringBytes)
    return refused("a text without a length (DM0100.20H)");
  point.at = parts.area + parts.digits;
  point.string_bytes = static_cast<std::uint16_t>(*bytes);
  if (order == 'L' || order == 'l') point.byte_order = ByteOrder::kLittleEndian;
  return point;
}

Made omron_point(const AddressParts& parts, Point point) {
  if (point.type == ValueType::kString) return omron_text(parts, std::move(point));
  // Timers and counters share their numbers, so both letters name the same item.
  const std::string area = parts.area == "TC" ? "T" : parts.area == "TS" ? "TF" : parts.area;
  if (area != parts.area) point.changes.push_back(fmt::format("{} is {} here", parts.area, area));
  point.at = area + parts.digits + (parts.suffix.empty() ? "" : "." + parts.suffix);
  return point;
}

tl::expected<void, std::string> append_elements(std::string_view protocol, AddressParts parts,
                                                const Point& point, std::vector<Point>& points) {
  if (point.type == ValueType::kBool || point.type == ValueType::kString)
    return refused("an array of bits or texts");
  const unsigned step =
      protocol == "s7-ppi" ? width_of(point.type) / 8 : registers_of(point.type, 0);
  const std::uint64_t first = parts.number();
  for (unsigned i = 0; i < parts.elements && points.size() <= kMaxPoints; ++i) {
    parts.digits = std::to_string(first + std::uint64_t{i} * step);
    Made made = protocol == "s7-ppi" ? s7_point(parts, point) : omron_point(parts, point);
    if (!made) return tl::unexpected(made.error());
    made->name = fmt::format("{}-{}", point.name, i);
    made->changes.push_back(fmt::format("element {} of an array of {}", i, parts.elements));
    points.push_back(*std::move(made));
  }
  return {};
}

}  // namespace

tl::expected<void, std::string> append_family_point(std::string_view protocol,
                                                    std::string_view address,
                                                    const std::string& type, const Point& given,
                                                    std::vector<Point>& points) {
  Point point = given;
  const std::optional<AddressParts> parts = parts_of(trimmed(address));
  const bool by_default = type.empty() || type == "default";
  const auto known = type_by_name(by_default ? "word" : type);
  if (!known) return tl::unexpected(fmt::format("data type '{}' is unknown", type));
  point.type = known->type;
  if (by_default && parts && whole_from(parts->suffix)) point.type = ValueType::kBool;
  if (by_default && protocol == "s7-ppi" && point.type != ValueType::kBool)
    return refused("data type 'Default': say Byte, Word, DWord .. in the list");
  point.at = trimmed(address);
  const bool converted = protocol == "s7-ppi" || protocol == "omron-hostlink";
  if (parts && parts->elements > 0) return append_elements(protocol, *parts, point, points);
  if (parts && converted) {
    Made made = protocol == "s7-ppi" ? s7_point(*parts, point) : omron_point(*parts, point);
    if (!made) return tl::unexpected(made.error());
    point = *std::move(made);
  } else if (point.type == ValueType::kString) {
    return refused("a text: how this driver writes its length is not known");
  }
  points.push_back(std::move(point));
  return {};
}

}  // namespace fieldcast::importing

#include "core/protocol/s7comm/s7_200.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "core/protocol/option_reader.hpp"

namespace fieldcast::s7comm {
namespace {

constexpr std::string_view kAllowed =
    "VB100, VW100, VD100, V100.3 and likewise M, I, Q, S, SM; AIW4, AQW0 (even numbers); T37, C5, "
    "HC0";

constexpr AddressFaults address_fault{kAllowed};

struct Named {
  AreaIndex area;
  unsigned width = 0;  // bits for B, W or D; 0: a bit or a number follows
};

std::optional<Named> named(std::span<const Area> areas, std::string_view letters) {
  for (AreaIndex area = 0; area < kS7200Areas; ++area) {
    const std::string_view name = areas[area].name;
    if (!letters.starts_with(name)) continue;
    const std::string_view width = letters.substr(name.size());
    const bool words = areas[area].item_bits == 16 && !kS7200Codes[area].counted;
    if (width.empty() && !words) return Named{area};
    if (kS7200Codes[area].counted) continue;
    if (words && width != "W") continue;
    if (width == "B") return Named{area, 8};
    if (width == "W") return Named{area, 16};
    if (width == "D") return Named{area, 32};
  }
  return std::nullopt;
}

// Accepts the German names of the Siemens software, and lower case.
std::string suggestion(std::span<const Area> areas, std::string_view letters,
                       std::string_view rest) {
  std::string upper = upper_case(letters);
  if (upper.starts_with("E"))
    upper[0] = 'I';
  else if (upper == "A" || upper == "AB" || upper == "AW" || upper == "AD")
    upper[0] = 'Q';
  else if (upper == "Z")
    upper = "C";
  else if (upper == "AI" || upper == "AQ")
    upper += "W";
  return named(areas, upper) ? upper + std::string(rest) : std::string{};
}

}  // namespace

ParsedOrFault parse_s7_200_address(std::span<const Area> areas, std::string_view at) {
  const std::size_t digits = std::min(at.find_first_of("0123456789"), at.size());
  const std::string_view letters = at.substr(0, digits);
  const auto name = named(areas, letters);
  if (!name)
    return address_fault("area " + in_quotes(letters) + " is unknown",
                         suggestion(areas, letters, at.substr(digits)));
  const Area& area = areas[name->area];
  const AreaCode& code = kS7200Codes[name->area];
  const std::size_t dot = at.find('.');
  const std::string_view number =
      at.substr(digits, dot == std::string_view::npos ? dot : dot - digits);
  const auto first = whole_number(number);
  if (!first) return address_fault(in_quotes(number) + " is no number");
  ParsedAddress address{.area = name->area, .first = *first};
  if (area.item_bits == 16 && !code.counted) {
    if (*first % 2 != 0)
      return address_fault(in_quotes(at) + ": words have even numbers",
                           std::string(letters) + std::to_string(*first - 1));
    address.first /= 2;
  }
  if (address.first >= area.items)
    return address_fault(in_quotes(at) + " is beyond the end of " + std::string(area.name));
  if (dot == std::string_view::npos) {
    if (name->width == 0 && !code.counted) {
      return address_fault(in_quotes(at) + " says neither a bit nor a width",
                           std::string(letters) + "B" + std::string(number));
    }
    if (!code.counted) address.width_bits = name->width;
    return address;
  }
  if (name->width != 0 || code.counted)
    return address_fault(in_quotes(at) + " has no bits", std::string(at.substr(0, dot)));
  if (!set_bit(address, whole_number(at.substr(dot + 1)), 8))
    return address_fault("bit " + in_quotes(at.substr(dot + 1)) + " is not 0..7",
                         std::string(at.substr(0, dot)) + ".0");
  return address;
}

}  // namespace fieldcast::s7comm

#include "tools/sim/families/ppi_memory.hpp"

#include <algorithm>

#include "tools/sim/device/digits.hpp"

namespace fieldcast::sim {

std::vector<ItemArea> ppi_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t i = 0; i < kPpiAreas.size(); ++i)
    areas.push_back({kPpiAreaNames[i], kPpiAreas[i].bits, kPpiAreas[i].items});
  return areas;
}

std::optional<ItemAddress> parse_ppi_address(std::string_view at) {
  const std::size_t digits = std::min(at.find_first_of("0123456789"), at.size());
  const std::size_t dot = at.find('.');
  const std::string_view letters = at.substr(0, digits);
  const auto number =
      address_number(at.substr(digits, dot == std::string_view::npos ? dot : dot - digits));
  if (!number || *number > 0xFFFFFF) return std::nullopt;
  for (std::size_t area = 0; area < kPpiAreas.size(); ++area) {
    if (!letters.starts_with(kPpiAreaNames[area])) continue;
    const std::string_view width = letters.substr(kPpiAreaNames[area].size());
    const bool words = kPpiAreas[area].bits == 16 && !kPpiAreas[area].counted;
    ItemAddress address{.area = area,
                        .first = static_cast<std::uint32_t>(words ? *number / 2 : *number)};
    if (kPpiAreas[area].counted && width.empty() && dot == std::string_view::npos) return address;
    if (words && width == "W" && *number % 2 == 0 && dot == std::string_view::npos) return address;
    if (kPpiAreas[area].bits != 8) continue;
    if (dot == std::string_view::npos && (width == "B" || width == "W" || width == "D"))
      return address;
    const auto bit =
        dot == std::string_view::npos ? std::nullopt : address_number(at.substr(dot + 1));
    if (!width.empty() || !bit || *bit > 7) continue;
    address.bit = static_cast<std::uint8_t>(*bit);
    return address;
  }
  return std::nullopt;
}

}  // namespace fieldcast::sim

#include "tools/sim/families/omron_memory.hpp"

#include <algorithm>

#include "tools/sim/device/digits.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::array<std::string_view, 11> kOtherNames{"IR", "WR",  "L",   "H",    "A",   "D",
                                                       "E",  "TIM", "CNT", "TIMF", "CNTF"};

}  // namespace

std::vector<ItemArea> omron_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t i = 0; i < kOmronAreas.size(); ++i) {
    const std::uint32_t banks = i == kOmronEm ? kOmronEmBanks : 1;
    areas.push_back({kOmronAreaNames[i], kOmronAreas[i].bits,
                     std::max(kOmronAreas[i].items, kOmronAreas[i].c_items) * banks});
  }
  return areas;
}

std::optional<ItemAddress> parse_omron_address(std::string_view at) {
  const std::size_t underscore = at.find('_');
  // The EM bank may be a letter: E1_100, EMC_0.
  const std::size_t digits = underscore != std::string_view::npos && underscore > 0
                                 ? underscore - 1
                                 : std::min(at.find_first_of("0123456789"), at.size());
  const std::string_view name = at.substr(0, digits);
  for (std::size_t area = 0; area < kOmronAreas.size(); ++area) {
    if (name != kOmronAreaNames[area] && name != kOtherNames[area]) continue;
    if ((area == kOmronEm) != (underscore != std::string_view::npos)) return std::nullopt;
    ItemAddress address{.area = area};
    std::string_view rest = at.substr(digits);
    if (area == kOmronEm) {
      const auto bank = address_number(rest.substr(0, 1), 16);
      if (!bank || *bank >= kOmronEmBanks) return std::nullopt;
      address.first = static_cast<std::uint32_t>(*bank) * kEmBankWords;
      rest = rest.substr(2);
    }
    const std::size_t dot = rest.find('.');
    const auto item = address_number(rest.substr(0, dot));
    if (!item || *item >= kEmBankWords) return std::nullopt;
    address.first += static_cast<std::uint32_t>(*item);
    if (dot == std::string_view::npos) return address;
    const auto bit = address_number(rest.substr(dot + 1));
    if (!bit || *bit >= kOmronAreas[area].bits || kOmronAreas[area].bits == 1) return std::nullopt;
    address.bit = static_cast<std::uint8_t>(*bit);
    return address;
  }
  return std::nullopt;
}

}  // namespace fieldcast::sim

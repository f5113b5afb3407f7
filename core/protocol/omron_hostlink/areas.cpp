#include "core/protocol/omron_hostlink/areas.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "core/base/message_text.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::omron {
namespace {

constexpr auto kBcd = ValueType::kBcd16;
constexpr std::uint32_t kEmC = kBankWords * 10, kEmFins = kBankWords * kBanks;
// Name, second spelling, C-mode letter and items; FINS word code, bit code and items; C-mode and
// FINS number of the first item; flags; type in C-mode.
constexpr AreaRow kRows[] = {
    {"CIO", "IR", 'R', 10000, 0xB0, 0x30, 6144, 0, 0, false, {}},
    {"W", "WR", 0, 0, 0xB1, 0x31, 512, 0, 0, false, {}},
    {"LR", "L", 'L', 200, 0, 0, 0, 0, 0, false, {}},
    {"HR", "H", 'H', 1536, 0xB2, 0x32, 1536, 0, 0, false, {}},
    {"AR", "A", 'J', 960, 0xB3, 0x33, 960, 0, 0, false, {}},
    {"DM", "D", 'D', 10000, 0x82, 0x02, 32768, 0, 0, false, {}},
    {"EM", "E", 'E', kEmC, 0xA0, 0x20, kEmFins, 0, 0, false, {}},
    {"T", "TIM", 'C', 2048, 0x89, 0, 4096, 0, 0, false, kBcd},
    {"C", "CNT", 'C', 2048, 0x89, 0, 4096, 2048, 0x8000, false, kBcd},
    {"TF", "TIMF", 'G', 2048, 0, 0x09, 4096, 0, 0, true, {}},
    {"CF", "CNTF", 'G', 2048, 0, 0x09, 4096, 2048, 0x8000, true, {}},
};

bool is_reached(const AreaRow& row, Mode mode) {
  return (mode == Mode::kCMode ? row.c_items : row.fins_items) != 0;
}

Reached find_reached(Mode mode) {
  const bool fins = mode != Mode::kCMode, ethernet = mode == Mode::kFinsEthernet;
  Reached reached;
  for (const AreaRow& each : kRows) {
    const AreaRow* row = &each;
    if (!is_reached(each, mode)) continue;
    Area area{.name = row->name,
              .item_bits = row->flags ? 1u : 16u,
              .type = fins ? std::nullopt : row->c_type,
              .items = fins ? row->fins_items : row->c_items};
    if (is_extended(*row)) area.bank = kBankWords;
    area.max_read = fins ? (row->flags ? kFinsReadFlags : kFinsReadWords)
                         : (row->flags ? kCReadFlags : kCReadWords);
    area.max_write =
        fins ? (row->flags ? 0 : kFinsWriteWords) : (row->flags ? kCWriteFlags : kCWriteWords);
    if (ethernet) area.max_read = row->flags ? kEthernetReadFlags : kEthernetReadWords;
    if (ethernet && !row->flags) area.max_write = kEthernetWriteWords;
    area.writable = area.max_write != 0;
    area.bit_write = fins && row->bit_code != 0 && !row->flags;
    // The lower address holds the lower word of a double word (CS/CJ instructions manual, W340,
    // 2-1); the high byte holds the first character of a text.
    if (!row->flags) area.word_order = WordOrder::kLittleEndian;
    reached.rows.push_back(row);
    reached.areas.push_back(area);
  }
  return reached;
}

constexpr AddressFaults kFaults[] = {
    {"CIO12, CIO12.03, LR7, HR10, AR3, DM100, E1_100, T5, C5 (present values), TF5, CF5 (flags)"},
    {"CIO12, CIO12.03, W5.07, HR10, AR3, DM100, E1_100, T5, C5 (present values), TF5, CF5 "
     "(flags)"}};

std::string suggest(Mode mode, std::string_view letters, std::string_view rest) {
  const std::string upper = upper_case(letters);
  std::vector<std::string_view> names;
  for (const AreaRow* row : reached_in(mode).rows)
    names.insert(names.end(), {row->name, row->other});
  const std::string_view near = near_miss(upper, names);
  if (near.empty() || near == "EM" || near == "E") return {};
  return std::string(near) + std::string(rest);
}

// "1_100": bank and word of EM.
std::optional<std::uint32_t> banked(std::string_view text) {
  const std::size_t line = text.find('_');
  if (line != 1) return std::nullopt;
  const char digit = text[0];
  const int bank = digit >= '0' && digit <= '9'   ? digit - '0'
                   : digit >= 'A' && digit <= 'C' ? digit - 'A' + 10
                                                  : -1;
  const auto word = whole_number(text.substr(line + 1));
  if (bank < 0 || !word || *word >= kBankWords) return std::nullopt;
  return static_cast<std::uint32_t>(bank) * kBankWords + *word;
}

}  // namespace

bool is_extended(const AreaRow& row) { return row.letter == 'E'; }

const Reached& reached_in(Mode mode) {
  static const Reached c = find_reached(Mode::kCMode);
  static const Reached fins = find_reached(Mode::kFins);
  static const Reached ethernet = find_reached(Mode::kFinsEthernet);
  return mode == Mode::kCMode ? c : mode == Mode::kFins ? fins : ethernet;
}

namespace {

// "DM100": the letters of the area, and the rest. The bank of EM may be a letter: "EMA_0".
std::pair<std::string_view, std::string_view> split_area(std::string_view at) {
  std::size_t letters = std::min(at.find_first_of("0123456789"), at.size());
  if (at.find('_') != std::string_view::npos && at.starts_with("E"))
    letters = at.starts_with("EM") ? 2 : 1;
  return {at.substr(0, letters), at.substr(letters)};
}

}  // namespace

ParsedOrFault parse_address(Mode mode, std::string_view at) {
  const AddressFaults& fault = kFaults[mode != Mode::kCMode];
  const auto [letters, rest] = split_area(at);
  const auto named = [wanted = letters](const AreaRow& row) {
    return row.name == wanted || row.other == wanted;
  };
  const auto row = std::ranges::find_if(kRows, named);
  if (row == std::end(kRows))
    return fault("area " + in_quotes(letters) + " is unknown", suggest(mode, letters, rest));
  const std::string name(row->name);
  if (!is_reached(*row, mode)) {
    return fault(name + (mode != Mode::kCMode ? " is not reached by FINS"
                                              : " is reached by FINS only (option mode: fins)"));
  }
  const auto& [rows, areas] = reached_in(mode);
  ParsedAddress address{.area =
                            static_cast<AreaIndex>(std::ranges::find(rows, &*row) - rows.begin())};
  const Area& area = areas[address.area];

  const std::size_t dot = rest.find('.');
  const auto first =
      is_extended(*row) ? banked(rest.substr(0, dot)) : whole_number(rest.substr(0, dot));
  if (!first)
    return fault(in_quotes(rest.substr(0, dot)) + " is no place in " + name,
                 name + (is_extended(*row) ? "0_0" : "0"));
  const bool past_digits = mode == Mode::kCMode && is_extended(*row) && *first % kBankWords > 9999;
  if (*first >= area.items || past_digits)
    return fault(in_quotes(at) + " is beyond the end of " + name);
  address.first = *first;
  if (row->flags) address.width_bits = 1;
  if (dot == std::string_view::npos) return address;

  const std::string whole = std::string(at.substr(0, at.find('.')));
  if (row->flags) return fault("a flag has no bits", whole);
  if (!set_bit(address, whole_number(rest.substr(dot + 1)), 16))
    return fault("bit " + in_quotes(rest.substr(dot + 1)) + " is not 00..15", whole + ".00");
  return address;
}

}  // namespace fieldcast::omron

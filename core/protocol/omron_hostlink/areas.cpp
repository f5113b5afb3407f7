#include "core/protocol/omron_hostlink/areas.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "core/base/message_text.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::array kRows{
    AreaRow{.name = "CIO",
            .other = "IR",
            .letter = 'R',
            .c_items = 10000,
            .word_code = 0xB0,
            .bit_code = 0x30,
            .fins_items = 6144},
    AreaRow{.name = "W", .other = "WR", .word_code = 0xB1, .bit_code = 0x31, .fins_items = 512},
    AreaRow{.name = "LR", .other = "L", .letter = 'L', .c_items = 200},
    AreaRow{.name = "HR",
            .other = "H",
            .letter = 'H',
            .c_items = 1536,
            .word_code = 0xB2,
            .bit_code = 0x32,
            .fins_items = 1536},
    AreaRow{.name = "AR",
            .other = "A",
            .letter = 'J',
            .c_items = 960,
            .word_code = 0xB3,
            .bit_code = 0x33,
            .fins_items = 960},
    AreaRow{.name = "DM",
            .other = "D",
            .letter = 'D',
            .c_items = 10000,
            .word_code = 0x82,
            .bit_code = 0x02,
            .fins_items = 32768},
    AreaRow{.name = "EM",
            .other = "E",
            .letter = 'E',
            .c_items = kBankWords * 10,
            .word_code = 0xA0,
            .bit_code = 0x20,
            .fins_items = kBankWords * kBanks},
    AreaRow{.name = "T",
            .other = "TIM",
            .letter = 'C',
            .c_items = 2048,
            .word_code = 0x89,
            .fins_items = 4096,
            .c_type = ValueType::kBcd16},
    AreaRow{.name = "C",
            .other = "CNT",
            .letter = 'C',
            .c_items = 2048,
            .word_code = 0x89,
            .fins_items = 4096,
            .c_offset = 2048,
            .fins_offset = 0x8000,
            .c_type = ValueType::kBcd16},
    AreaRow{.name = "TF",
            .other = "TIMF",
            .letter = 'G',
            .c_items = 2048,
            .bit_code = 0x09,
            .fins_items = 4096,
            .flags = true},
    AreaRow{.name = "CF",
            .other = "CNTF",
            .letter = 'G',
            .c_items = 2048,
            .bit_code = 0x09,
            .fins_items = 4096,
            .c_offset = 2048,
            .fins_offset = 0x8000,
            .flags = true},
};

bool is_reached(const AreaRow& row, Mode mode) {
  return (mode == Mode::kFins ? row.fins_items : row.c_items) != 0;
}

std::vector<const AreaRow*> rows_reached(Mode mode) {
  std::vector<const AreaRow*> rows;
  for (const AreaRow& row : kRows) {
    if (is_reached(row, mode)) rows.push_back(&row);
  }
  return rows;
}

std::vector<Area> areas_reached(Mode mode) {
  const bool fins = mode == Mode::kFins;
  std::vector<Area> areas;
  for (const AreaRow* row : rows_of(mode)) {
    Area area{.name = row->name,
              .item_bits = row->flags ? 1u : 16u,
              .type = fins ? std::nullopt : row->c_type,
              .items = fins ? row->fins_items : row->c_items};
    if (is_extended(*row)) area.bank = kBankWords;
    area.max_read = fins ? (row->flags ? kFinsReadFlags : kFinsReadWords)
                         : (row->flags ? kCReadFlags : kCReadWords);
    area.max_write =
        fins ? (row->flags ? 0 : kFinsWriteWords) : (row->flags ? kCWriteFlags : kCWriteWords);
    area.writable = area.max_write != 0;
    area.bit_write = fins && row->bit_code != 0 && !row->flags;
    // The lower address holds the lower word of a double word (CS/CJ instructions manual, W340,
    // 2-1); the high byte holds the first character of a text.
    if (!row->flags) area.word_order = WordOrder::kLittleEndian;
    areas.push_back(area);
  }
  return areas;
}

constexpr std::string_view kAllowedC =
    "CIO12, CIO12.03, LR7, HR10, AR3, DM100, E1_100, T5, C5 (present values), TF5, CF5 (flags)";
constexpr std::string_view kAllowedFins =
    "CIO12, CIO12.03, W5.07, HR10, AR3, DM100, E1_100, T5, C5 (present values), TF5, CF5 (flags)";

using Parsed = tl::expected<ParsedAddress, AddressFault>;

Parsed fault(Mode mode, std::string what, std::string suggestion = {}) {
  return tl::unexpected(AddressFault{std::move(what),
                                     std::string(mode == Mode::kFins ? kAllowedFins : kAllowedC),
                                     std::move(suggestion)});
}

std::string suggest(Mode mode, std::string_view letters, std::string_view rest) {
  const std::string upper = upper_case(letters);
  std::vector<std::string_view> names;
  for (const AreaRow* row : rows_of(mode)) names.insert(names.end(), {row->name, row->other});
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

const std::vector<const AreaRow*>& rows_of(Mode mode) {
  static const std::vector<const AreaRow*> c = rows_reached(Mode::kCMode);
  static const std::vector<const AreaRow*> fins = rows_reached(Mode::kFins);
  return mode == Mode::kFins ? fins : c;
}

const std::vector<Area>& areas_of(Mode mode) {
  static const std::vector<Area> c = areas_reached(Mode::kCMode);
  static const std::vector<Area> fins = areas_reached(Mode::kFins);
  return mode == Mode::kFins ? fins : c;
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

tl::expected<ParsedAddress, AddressFault> parse_address(Mode mode, std::string_view at) {
  const auto [letters, rest] = split_area(at);
  const auto named = [letters = letters](const AreaRow& row) {
    return row.name == letters || row.other == letters;
  };
  const auto row = std::find_if(kRows.begin(), kRows.end(), named);
  if (row == kRows.end())
    return fault(mode, "area " + quoted(letters) + " is unknown", suggest(mode, letters, rest));
  const std::string name(row->name);
  if (!is_reached(*row, mode)) {
    return fault(mode,
                 name + (mode == Mode::kFins ? " is not reached by FINS"
                                             : " is reached by FINS only (option mode: fins)"));
  }
  const auto& rows = rows_of(mode);
  ParsedAddress address{
      .area = static_cast<AreaIndex>(std::find(rows.begin(), rows.end(), &*row) - rows.begin())};
  const Area& area = areas_of(mode)[address.area];

  const std::size_t dot = rest.find('.');
  const auto first =
      is_extended(*row) ? banked(rest.substr(0, dot)) : whole_number(rest.substr(0, dot));
  if (!first)
    return fault(mode, quoted(rest.substr(0, dot)) + " is no place in " + name,
                 name + (is_extended(*row) ? "0_0" : "0"));
  const bool past_digits = mode == Mode::kCMode && is_extended(*row) && *first % kBankWords > 9999;
  if (*first >= area.items || past_digits)
    return fault(mode, quoted(at) + " is beyond the end of " + name);
  address.first = *first;
  if (row->flags) address.width_bits = 1;
  if (dot == std::string_view::npos) return address;

  const std::string whole = std::string(at.substr(0, at.find('.')));
  if (row->flags) return fault(mode, "a flag has no bits", whole);
  const auto bit = whole_number(rest.substr(dot + 1));
  if (!bit || *bit > 15)
    return fault(mode, "bit " + quoted(rest.substr(dot + 1)) + " is not 00..15", whole + ".00");
  address.bit = static_cast<std::uint8_t>(*bit);
  address.width_bits = 1;
  return address;
}

}  // namespace fieldcast::omron

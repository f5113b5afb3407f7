#include "core/protocol/mitsubishi_mc/areas.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "core/protocol/option_reader.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr auto kInt16 = ValueType::kInt16;
constexpr std::uint32_t kMany = 1u << 20, kData = 5u << 20;
// Name, name in the iQ-R series, code, base of numbers, in ASCII code, bits, items, writable, type.
constexpr DeviceRow kRows[] = {
    {"D", "", 0xA8, 10, 10, 16, kData, true, {}},
    {"W", "", 0xB4, 16, 16, 16, kData, true, {}},
    {"R", "", 0xAF, 10, 10, 16, 32768, true, {}},
    {"ZR", "", 0xB0, 10, 16, 16, 2 * kData, true, {}},
    {"SD", "", 0xA9, 10, 10, 16, 16384, true, {}},
    {"SW", "", 0xB5, 16, 16, 16, 32768, true, {}},
    {"Z", "", 0xCC, 10, 10, 16, 32, true, {}},
    {"TN", "", 0xC2, 10, 10, 16, kMany, true, kInt16},
    {"SN", "STN", 0xC8, 10, 10, 16, kMany, true, kInt16},
    {"CN", "", 0xC5, 10, 10, 16, kMany, true, kInt16},
    {"M", "", 0x90, 10, 10, 1, kMany, true, {}},
    {"L", "", 0x92, 10, 10, 1, 32768, true, {}},
    {"F", "", 0x93, 10, 10, 1, 32768, true, {}},
    {"V", "", 0x94, 10, 10, 1, 32768, true, {}},
    {"B", "", 0xA0, 16, 16, 1, kMany, true, {}},
    {"X", "", 0x9C, 16, 16, 1, 0x3000, true, {}},
    {"Y", "", 0x9D, 16, 16, 1, 0x3000, true, {}},
    {"SM", "", 0x91, 10, 10, 1, 16384, true, {}},
    {"SB", "", 0xA1, 16, 16, 1, 32768, true, {}},
    {"S", "", 0x98, 10, 10, 1, 16384, true, {}},
    {"TS", "", 0xC1, 10, 10, 1, kMany, false, {}},
    {"TC", "", 0xC0, 10, 10, 1, kMany, false, {}},
    {"SS", "STS", 0xC7, 10, 10, 1, kMany, false, {}},
    {"SC", "STC", 0xC6, 10, 10, 1, kMany, false, {}},
    {"CS", "", 0xC4, 10, 10, 1, kMany, false, {}},
    {"CC", "", 0xC3, 10, 10, 1, kMany, false, {}},
};

constexpr std::uint32_t kSixDigits = 1'000'000;

Reached find_reached(const Format& format) {
  const std::uint16_t bits = format.ascii ? 3584 : 7168;
  Reached reached = reached_from(kRows, {.words = 960, .read_bits = bits, .write_bits = bits});
  for (std::size_t i = 0; i < reached.rows.size(); ++i) {
    if (format.ascii && !format.wide && reached.rows[i]->ascii_base == 10)
      reached.areas[i].items = std::min(reached.areas[i].items, kSixDigits);
  }
  return reached;
}

constexpr AddressFaults kFault{
    "D100, D100.5, W1A0, R5, ZR5, SD203, SW1F, Z3, TN5, SN5, CN5 (values), M14, L3, F3, V3, B1F, "
    "X1F, Y20, SM400, SB1F, S3, TS5, SS5, CS5 (contacts), TC5, SC5, CC5 (coils); W, SW, B, SB, X "
    "and Y are hexadecimal"};

bool is_named(const DeviceRow& row, std::string_view name) {
  return row.name == name || (!row.other.empty() && row.other == name);
}

// The longest name of a device at the beginning: a hexadecimal number may begin with a letter.
const DeviceRow* find_row(const Reached& reached, std::string_view at, std::size_t& length) {
  for (length = std::min<std::size_t>(at.size(), 3); length > 0; --length) {
    const auto row = std::ranges::find_if(
        reached.rows, [&](const DeviceRow* each) { return is_named(*each, at.substr(0, length)); });
    if (row != reached.rows.end()) return *row;
  }
  return nullptr;
}

std::string_view letters_of(std::string_view at) {
  return at.substr(0, std::min(at.find_first_of("0123456789."), at.size()));
}

ParsedOrFault unknown_device(const Reached& reached, const AddressFaults& fault,
                             std::string_view at) {
  const std::string_view letters = letters_of(at);
  const std::string upper = upper_case(at);
  std::size_t length = 0;
  std::string suggestion = upper != at && find_row(reached, upper, length) != nullptr ? upper : "";
  // The program calls a timer T5: its value is TN5.
  if (letters == "T" || letters == "C" || letters == "ST")
    suggestion = std::string(letters) + "N" + std::string(at.substr(letters.size()));
  return fault("device " + in_quotes(letters) + " is unknown", suggestion);
}

// Decimal, or one hexadecimal digit as the programming software writes it.
std::optional<std::uint32_t> bit_number(std::string_view text) {
  const bool letter = text.size() == 1 && text[0] >= 'A' && text[0] <= 'F';
  return whole_number(text, letter ? 16 : 10);
}

}  // namespace

Reached reached_from(std::span<const DeviceRow> rows, const AreaLimits& limits) {
  Reached reached;
  for (const DeviceRow& row : rows) {
    const bool bits = row.item_bits == 1;
    Area area{.name = row.name, .item_bits = row.item_bits, .type = row.type, .items = row.items};
    area.writable = row.writable;
    area.max_read = bits ? limits.read_bits : limits.words;
    area.max_write = !row.writable ? std::uint16_t{0} : bits ? limits.write_bits : limits.words;
    area.bit_write = bits && row.writable;
    // D1500 holds the low word of D1501, D1500 (SH-080008, 8.3, example of the random read), and
    // the low byte of a word the first character of a text, as in FX.
    if (!bits) {
      area.word_order = WordOrder::kLittleEndian;
      area.text_order = ByteOrder::kLittleEndian;
    }
    reached.rows.push_back(&row);
    reached.areas.push_back(area);
  }
  return reached;
}

const Reached& reached_by(const Format& format) {
  static const std::array<Reached, 3> sets{find_reached({}), find_reached({.ascii = true}),
                                           find_reached({.ascii = true, .wide = true})};
  return sets[!format.ascii ? 0 : format.wide ? 2 : 1];
}

ParsedOrFault parse_device(const Reached& reached, const AddressFaults& fault,
                           std::string_view at) {
  std::size_t name = 0;
  const DeviceRow* row = find_row(reached, at, name);
  if (row == nullptr || letters_of(at) == "ST") return unknown_device(reached, fault, at);
  const std::size_t dot = std::min(at.find('.'), at.size());
  const std::string_view number = at.substr(name, std::max(dot, name) - name);
  const auto which = whole_number(number, row->base);
  if (!which) {
    return fault(in_quotes(number) + (row->base == 16  ? " is not a hexadecimal number"
                                      : row->base == 8 ? " is not an octal number"
                                                       : " is not a decimal number"),
                 std::string(at.substr(0, name)) + "0");
  }
  const auto& [rows, areas] = reached;
  ParsedAddress address{.area = static_cast<AreaIndex>(std::ranges::find(rows, row) - rows.begin()),
                        .first = *which};
  if (*which >= areas[address.area].items)
    return fault(in_quotes(at) + " is beyond the end of " + std::string(row->name));
  if (row->item_bits == 1) address.width_bits = 1;
  if (dot == at.size()) return address;
  const std::string whole(at.substr(0, dot));
  if (row->item_bits == 1) return fault(in_quotes(whole) + " is a bit itself", whole);
  if (!set_bit(address, bit_number(at.substr(dot + 1)), row->item_bits))
    return fault("bit " + in_quotes(at.substr(dot + 1)) + " does not exist", whole + ".0");
  return address;
}

ParsedOrFault parse_address(const Format& format, std::string_view at) {
  return parse_device(reached_by(format), kFault, at);
}

}  // namespace fieldcast::mitsubishi_mc

#include "core/protocol/mitsubishi_fx/areas.hpp"

#include <algorithm>
#include <string>

#include "core/protocol/option_reader.hpp"

namespace fieldcast::mitsubishi_fx {
namespace {

// Bits are stored eight per byte from the base; words have two bytes, 32-bit counters four. Entries
// of the extended map on which the sources disagree are empty (contacts and coils of timers and
// counters, 32-bit counters).
constexpr auto kInt16 = ValueType::kInt16, kInt32 = ValueType::kInt32;
// Name, second spelling, bits, first number, octal, type; items, base and force of both maps.
constexpr DeviceRow kRows[] = {
    {"D", "", 16, 0, false, {}, {8000, 0x1000, {}}, {8000, 0x4000, {}}},
    {"D", "", 16, 8000, false, {}, {256, 0x0E00, {}}, {512, 0x8000, {}}},
    {"T", "TN", 16, 0, false, kInt16, {256, 0x0800, {}}, {320, 0x1000, {}}},
    {"C", "CN", 16, 0, false, kInt16, {200, 0x0A00, {}}, {200, 0x0A00, {}}},
    {"C", "CN", 32, 200, false, kInt32, {56, 0x0C00, {}}, {}},
    {"M", "", 1, 0, false, {}, {1536, 0x0100, 0x0800}, {7680, 0x8800, 0x4000}},
    {"M", "", 1, 8000, false, {}, {256, 0x01E0, 0x0F00}, {512, 0x8C00, 0x6000}},
    {"X", "", 1, 0, true, {}, {256, 0x0080, {}}, {256, 0x8CA0, {}}},
    {"Y", "", 1, 0, true, {}, {256, 0x00A0, 0x0500}, {256, 0x8BC0, 0x5E00}},
    {"S", "", 1, 0, false, {}, {1000, 0x0000, 0x0000}, {4096, 0x8CE0, 0x6700}},
    {"TS", "", 1, 0, false, {}, {256, 0x00C0, {}}, {}},
    {"TC", "", 1, 0, false, {}, {256, 0x02C0, {}}, {}},
    {"CS", "", 1, 0, false, {}, {256, 0x01C0, {}}, {}},
    {"CC", "", 1, 0, false, {}, {256, 0x03C0, {}}, {}},
};

// The first number distinguishes two areas of the same name.
std::string_view area_name(const DeviceRow& row) {
  if (row.first == 8000) return row.name == "D" ? "D8000" : "M8000";
  return row.first == 200 ? "C200" : row.name;
}

Reached find_reached(Commands commands) {
  Reached reached;
  for (const DeviceRow& each : kRows) {
    const DeviceRow* row = &each;
    if (row->address_map(commands).items == 0) continue;
    const bool bits = row->item_bits == 1;
    const auto in_frame = static_cast<std::uint16_t>(kMaxBytes * 8 / row->item_bits);
    Area area{.name = area_name(*row),
              .item_bits = row->item_bits,
              .type = row->type,
              .items = row->address_map(commands).items};
    area.max_read = in_frame;
    // Bits are forced one by one.
    area.max_write = bits ? (row->address_map(commands).force ? 1 : 0) : in_frame;
    area.writable = area.max_write != 0;
    area.bit_write = bits && area.writable;
    area.alignment = bits ? 8 : 1;
    // D0 holds the low word of the pair D1, D0, and the low byte of a word holds the first
    // character of a text (FX programming manual, 32-bit data and string handling). A 32-bit
    // counter is one item, ordered by the device.
    if (row->item_bits == 16) {
      area.word_order = WordOrder::kLittleEndian;
      area.text_order = ByteOrder::kLittleEndian;
    }
    reached.rows.push_back(row);
    reached.areas.push_back(area);
  }
  return reached;
}

constexpr std::string_view kAllowed =
    "D100, D100.3, D8010, M14, M8001, X17 and Y5 (octal), S3, T5 and C5 (values), TS5, CS5 "
    "(contacts), TC5, CC5 (coils)";

constexpr AddressFaults address_fault{kAllowed};

bool is_named(const DeviceRow& row, std::string_view letters) {
  return row.name == letters || (!row.other.empty() && row.other == letters);
}

}  // namespace

const Reached& reached_by(Commands commands) {
  static const Reached classic = find_reached(Commands::kClassic);
  static const Reached extended = find_reached(Commands::kExtended);
  return commands == Commands::kClassic ? classic : extended;
}

ParsedOrFault parse_address(Commands commands, std::string_view at) {
  const std::size_t digits = std::min(at.find_first_of("0123456789"), at.size());
  const std::string_view letters = at.substr(0, digits);
  const std::size_t dot = std::min(at.find('.'), at.size());
  const std::string_view number = at.substr(digits, std::max(dot, digits) - digits);
  bool known = false;
  bool octal = false;
  for (const DeviceRow& row : kRows) {
    if (!is_named(row, letters)) continue;
    known = true;
    octal = row.octal;
  }
  if (!known) {
    const std::string upper = upper_case(letters);
    const bool named =
        std::ranges::any_of(kRows, [&](const DeviceRow& row) { return is_named(row, upper); });
    return address_fault("device " + in_quotes(letters) + " is unknown",
                         named ? upper + std::string(at.substr(digits)) : "");
  }
  const auto which = whole_number(number, octal ? 8 : 10);
  if (!which)
    return address_fault(in_quotes(number) + (octal ? " is no octal number" : " is no number"),
                         std::string(letters) + "0");
  const auto& rows = reached_by(commands).rows;
  const auto row = std::ranges::find_if(rows, [&](const DeviceRow* each) {
    return is_named(*each, letters) && *which >= each->first &&
           *which - each->first < each->address_map(commands).items;
  });
  if (row == rows.end())
    return address_fault(in_quotes(at) + " does not exist" +
                         (commands == Commands::kExtended ? " in the extended map" : ""));
  ParsedAddress address{.area = static_cast<AreaIndex>(row - rows.begin()),
                        .first = *which - (*row)->first};
  if ((*row)->item_bits != 16) address.width_bits = (*row)->item_bits;
  if (dot == at.size()) return address;
  const std::string whole(at.substr(0, dot));
  if ((*row)->item_bits == 1) return address_fault(in_quotes(whole) + " is a bit itself", whole);
  if (!set_bit(address, whole_number(at.substr(dot + 1)), (*row)->item_bits))
    return address_fault("bit " + in_quotes(at.substr(dot + 1)) + " does not exist", whole + ".0");
  return address;
}

}  // namespace fieldcast::mitsubishi_fx

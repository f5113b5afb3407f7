// Tag lists of KEPServerEX and related products. Word order and address base are not in the list;
// the driver's defaults are assumed. --protocol selects the driver of another family than Modbus.
// Most of their addresses are equal to ours; these differ:
//
// s7-ppi           V100 with type Word is VW100; V100.3 stays; T37, C5 and HC0 are values
// omron-hostlink   TC005 is the value of a timer or counter, TS005 its flag; DM0100.20H a text
//
// Source: Kepware, feature page CSV import and export (columns); Modbus driver help (addresses,
// data types); "S7-200 Addressing" and "C200H Addressing" (Omron Host Link), support.ptc.com;
// Modbus device defaults from github.com/atc-net/atc-kepware: zero-based addressing, first word
// low, first double word low.
#include <algorithm>
#include <cctype>

#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

constexpr Words<Field> kKepwareColumns[] = {
    {"tagname", Field::kName},        {"address", Field::kAddress},
    {"datatype", Field::kType},       {"clientaccess", Field::kAccess},
    {"scanrate", Field::kRefresh},    {"scaling", Field::kScaling},
    {"rawlow", Field::kRawLow},       {"rawhigh", Field::kRawHigh},
    {"scaledlow", Field::kScaledLow}, {"scaledhigh", Field::kScaledHigh},
    {"clamplow", Field::kClampLow},   {"clamphigh", Field::kClampHigh},
    {"engunits", Field::kUnit},       {"description", Field::kDescription},
    {"negatevalue", Field::kNegate}};
constexpr std::string_view kWithoutMeaning = "respectdatatype scaleddatatype";

constexpr unsigned kMaxArray = 1000;

// "400001", "40001.5", "H400A1", "400001[10]", "400001[2][5]", "400010.20H" of a string.
struct KepwareAddress {
  Reference reference;
  unsigned elements = 0;  // 0: not an array
  std::uint16_t string_bytes = 0;
  bool low_first = false;  // of a string
};
using ParsedKepware = Result<KepwareAddress>;

Result<unsigned> elements_of(std::string_view brackets) {
  unsigned elements = 1;
  while (!brackets.empty()) {
    const auto [inside, rest] = halves(brackets, ']');
    const auto count = inside.starts_with('[') && inside.size() < brackets.size()
                           ? whole_from<unsigned>(inside.substr(1), 1, kMaxArray)
                           : std::nullopt;
    if (!count || elements * *count > kMaxArray)
      return refused("'{}' is no array of 1 to {}", brackets, kMaxArray);
    elements *= *count;
    brackets = trimmed(rest);
  }
  return elements;
}

ParsedKepware hexadecimal(std::string_view text, unsigned base) {
  if (text.empty()) return refused("'H' is no address");
  const auto digits =
      whole_from<std::uint32_t>(fmt::format("0x{}", text.substr(1)), base, 65535 + base);
  const auto area = area_of_digit(text[0]);
  if (!digits || !area) return refused("'H{}' is no address", text);
  return KepwareAddress{{area, *digits - base, {}}};
}

ParsedKepware string_address(std::string_view text, unsigned base) {
  auto [place, length] = halves(text, '.');
  KepwareAddress address;
  const std::string order = length.empty() ? "" : lower(length.substr(length.size() - 1));
  address.low_first = order == "l";
  if (is_one_of(order, "l h")) length.remove_suffix(1);
  const auto bytes = whole_from<std::uint16_t>(length, 1, kMaxStringBytes);
  if (!bytes) return refused("a text of '{}' bytes; 1 to {} can be read", length, kMaxStringBytes);
  auto reference = reference_from(place, base);
  if (!reference) return tl::unexpected(reference.error());
  address.reference = *reference;
  address.string_bytes = *bytes;
  return address;
}

ParsedKepware kepware_address(std::string_view text, bool is_string, unsigned base) {
  text = trimmed(text);
  const std::size_t bracket = std::min(text.find('['), text.size());
  const auto elements = elements_of(text.substr(bracket));
  if (!elements) return tl::unexpected(elements.error());
  const bool array = bracket < text.size();
  text = trimmed(text.substr(0, bracket));
  ParsedKepware parsed;
  if (text.starts_with('H') || text.starts_with('h')) {
    parsed = hexadecimal(text.substr(1), base);
  } else if (is_string && contains(text, ".")) {
    parsed = string_address(text, base);
  } else {
    parsed = reference_from(text, base).map([](const Reference& at) { return KepwareAddress{at}; });
  }
  if (parsed && !parsed->reference.area)
    return refused(
        "'{}' does not begin with 0, 1, 3 or 4 of a Modbus area; for a driver of another family "
        "say --protocol",
        text);
  if (parsed && array) parsed->elements = *elements;
  return parsed;
}

// An address of another family. "DM0100.20H": letters, a number, and a suffix after a dot.
// "V0100[4]": elements.
struct AddressParts {
  std::string area, digits;
  std::string_view suffix;
  unsigned elements = 0;  // 0: not an array
};

std::optional<AddressParts> parts_of(std::string_view text) {
  AddressParts parts;
  for (; !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])); text.remove_prefix(1))
    parts.area += static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  for (; !text.empty() && is_digit(text[0]); text.remove_prefix(1)) parts.digits += text[0];
  if (parts.area.empty() || parts.digits.empty() || parts.digits.size() > 6) return std::nullopt;
  if (text.starts_with('[') && text.ends_with(']')) {
    const auto count = whole_from<unsigned>(text.substr(1, text.size() - 2), 1, kMaxArray);
    parts.elements = count.value_or(0);
    return count ? std::optional(parts) : std::nullopt;
  }
  if (!text.empty() && text[0] != '.') return std::nullopt;
  parts.suffix = text.substr(text.empty() ? 0 : 1);
  return parts;
}

unsigned width_of(ValueType type) {
  return is_byte(type) || type == ValueType::kBcd8 ? 8 : 16 * registers_of(type, 0);
}

// Our address contains the width; in Kepware the type does.
MayFail s7_point(const AddressParts& parts, Point& point) {
  const std::uint64_t number = whole_from(parts.digits).value_or(0);
  const bool bool_type = point.type == ValueType::kBool;
  if (point.type == ValueType::kString) return "a text: its length is not known";
  if (is_one_of(parts.area, "T C HC")) {
    if (bool_type) return "the status bit of a timer or counter is not read by PPI here";
    point.at = fmt::format("{}{}", parts.area, number);
  } else if (is_one_of(parts.area, "AI AQ")) {
    point.at = fmt::format("{}W{}", parts.area, number);
  } else if (parts.suffix.empty()) {
    if (bool_type) return "a Boolean without a bit";
    const unsigned bits = width_of(point.type);
    if (bits > 32) return "values of 64 bits are not read by PPI";
    point.at = fmt::format("{}{}{}", parts.area, bits == 8 ? "B" : bits == 16 ? "W" : "D", number);
  } else {
    const auto bit = whole_from(parts.suffix);
    if (!bit) return fmt::format("'.{}' is no bit", parts.suffix);
    if (*bit > 7)
      return fmt::format("bit {} of a word or double word: name the byte and a bit from 0 to 7",
                         *bit);
    if (!bool_type) return "a number whose address names a bit";
    point.at = fmt::format("{}{}.{}", parts.area, number, *bit);
  }
  return std::nullopt;
}

MayFail omron_point(const AddressParts& parts, Point& point) {
  if (point.type == ValueType::kString) {
    // "20H": the first character is in the high byte; "20L": in the low byte.
    const std::size_t digits = parts.suffix.size() - (parts.suffix.empty() ? 0 : 1);
    const std::string order = lower(parts.suffix.substr(digits));
    if (is_one_of(order, "d e")) return "a text with one character in a word";
    const auto bytes =
        whole_from<std::uint16_t>(parts.suffix.substr(0, digits), 1, kMaxStringBytes);
    if (!bytes || !is_one_of(order, "h l")) return "a text without a length (DM0100.20H)";
    point.at = parts.area + parts.digits;
    point.string_bytes = *bytes;
    point.set_orders(false, order == "l");
    return std::nullopt;
  }
  // Timers and counters share their numbers, so both letters name the same item.
  const std::string area = parts.area == "TC" ? "T" : parts.area == "TS" ? "TF" : parts.area;
  if (area != parts.area) point.change("{} is {} here", parts.area, area);
  point.at =
      fmt::format("{}{}{}{}", area, parts.digits, parts.suffix.empty() ? "" : ".", parts.suffix);
  return std::nullopt;
}

MayFail append_elements(bool s7, AddressParts parts, const Point& first,
                        std::vector<Point>& points) {
  if (!is_number(first.type)) return "an array of bits or texts";
  const unsigned step = s7 ? width_of(first.type) / 8 : registers_of(first.type, 0);
  const std::uint64_t number = whole_from(parts.digits).value_or(0);
  for (unsigned i = 0; i < parts.elements && points.size() <= kMaxPoints; ++i) {
    parts.digits = std::to_string(number + std::uint64_t{i} * step);
    Point point = first;
    if (auto fault = s7 ? s7_point(parts, point) : omron_point(parts, point)) return fault;
    point.name = fmt::format("{}-{}", first.name, i);
    point.change("element {} of an array of {}", i, parts.elements);
    points.push_back(std::move(point));
  }
  return std::nullopt;
}

// `type`: in lower case, without " array". The validation checks addresses that are not converted.
MayFail append_family_point(std::string_view protocol, std::string_view address,
                            std::string_view type, Point point, std::vector<Point>& points) {
  const std::optional<AddressParts> parts = parts_of(trimmed(address));
  const bool by_default = type.empty() || type == "default", s7 = protocol == "s7-ppi";
  const auto known = type_by_name(by_default ? "word" : type);
  if (!known) return fmt::format("data type '{}' is unknown", type);
  point.type = known->type;
  if (by_default && parts && whole_from(parts->suffix)) point.type = ValueType::kBool;
  if (by_default && s7 && point.type != ValueType::kBool)
    return "data type 'Default': say Byte, Word, DWord .. in the list";
  point.at = trimmed(address);
  if (parts && parts->elements > 0) return append_elements(s7, *parts, point, points);
  if (parts && (s7 || protocol == "omron-hostlink")) {
    if (auto fault = s7 ? s7_point(*parts, point) : omron_point(*parts, point)) return fault;
  } else if (point.type == ValueType::kString) {
    return "a text: how this driver writes its length is not known";
  }
  points.push_back(std::move(point));
  return std::nullopt;
}

class TagRow {
 public:
  TagRow(const Columns& columns, const Row& row, const ReadOptions& options)
      : columns_(columns), row_(row), options_(options) {}

  MayFail read(Point& point, std::vector<Point>& points) const {
    if (point.name.empty()) return "the tag has no name";
    std::string type = lower(cell(Field::kType));
    const bool array = type.ends_with(" array");
    if (array) type.resize(type.size() - 6);
    if (type == "date") return "dates are no type of a channel";
    read_words(point);
    if (auto fault = read_scaling(point)) return fault;
    if (!options_.is_modbus())
      return append_family_point(options_.protocol, cell(Field::kAddress), type, point, points);
    const auto address =
        kepware_address(cell(Field::kAddress), type == "string", options_.base.value_or(1));
    if (!address) return address.error();
    const auto& [area, first, bit] = address->reference;
    if (auto fault = read_type(type, *address, point)) return fault;
    if (!can_be_written(*area)) point.access = Access::kReadOnly;
    if (array && address->elements == 0) return "an array without a number of elements";
    point.at = address_text(*area, first, bit);
    append_points(points, std::move(point), *area, first, address->elements);
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::string_view cell(Field field) const { return columns_.cell(row_, field); }

  void read_words(Point& point) const {
    point.unit = cell(Field::kUnit);
    point.description = cell(Field::kDescription);
    const std::string access = column_word(cell(Field::kAccess));
    if (access.empty() || is_one_of(access, "rw readwrite")) point.access = Access::kReadWrite;
    if (is_one_of(access, "wo writeonly")) point.access = Access::kWriteOnly;
    point.refresh = milliseconds_from(cell(Field::kRefresh), 0.001, 1e10);
  }

  MayFail read_scaling(Point& point) const {
    const std::string scaling = column_word(cell(Field::kScaling));
    if (scaling == "squareroot")
      return "square-root scaling: a channel scales linearly; without the scaling in the list "
             "the raw value can be moved";
    if (!scaling.empty() && scaling != "none") {
      if (scaling != "linear") return fmt::format("scaling '{}' is unknown", scaling);
      const auto raw_low = number_from(cell(Field::kRawLow));
      const auto raw_high = number_from(cell(Field::kRawHigh));
      const auto low = number_from(cell(Field::kScaledLow));
      const auto high = number_from(cell(Field::kScaledHigh));
      if (!raw_low || !raw_high || !low || !high || *raw_low == *raw_high)
        return "linear scaling without its four numbers";
      point.scale = (*high - *low) / (*raw_high - *raw_low);
      point.offset = *low - *raw_low * point.scale;
      if (point.scale == 0) return "linear scaling to one single value";
      for (const auto& [field, side] :
           {std::pair{Field::kClampLow, "below"}, std::pair{Field::kClampHigh, "above"}}) {
        if (whole_from(cell(field)) == 1u)
          point.change("values {} the scaled range are shown as they are, not clamped", side);
      }
    }
    if (whole_from(cell(Field::kNegate)) == 1u) {
      point.scale = -point.scale;
      point.offset = point.offset == 0 ? 0 : -point.offset;
    }
    return std::nullopt;
  }

  MayFail read_type(const std::string& type, const KepwareAddress& address, Point& point) const {
    const bool bit = holds_bits(*address.reference.area) || address.reference.bit;
    if (type.empty() || type == "default") {
      point.type = bit ? ValueType::kBool : ValueType::kUint16;
    } else {
      const auto known = type_by_name(type);
      if (!known) return fmt::format("data type '{}' is unknown", type);
      point.type = known->type;
    }
    if (bit && point.type != ValueType::kBool)
      return fmt::format("data type '{}' at a single bit", type);
    if (!bit && point.type == ValueType::kBool) return "a Boolean at a register without a bit";
    if (point.type == ValueType::kString) {
      if (address.string_bytes == 0) return "a text without a length (400001.20H)";
      point.string_bytes = address.string_bytes;
      point.set_orders(false, address.low_first);
    } else if (is_byte(point.type)) {
      point.byte = 0;
    } else if (registers_of(point.type, 0) > 1) {
      point.word_order = options_.word_order.value_or(WordOrder::kLittleEndian);
    }
    return std::nullopt;
  }

  const Columns& columns_;
  const Row& row_;
  const ReadOptions& options_;
};

Confidence recognise_kepware(const SourceText& source) {
  const auto table = read_table(source.text.substr(0, source.text.find('\n', 200)));
  if (!table || table->rows.empty()) return 0;
  const Columns columns(table->rows.front(), kKepwareColumns);
  const bool named = columns.has(Field::kName) && columns.has(Field::kAddress);
  if (!named) return 0;
  return columns.known() >= 5 ? kCertain : columns.known() >= 3 ? kLikely : 0;
}

MayFail read_tags(const SourceText& source, const ReadOptions& options, Found& found, bool& wide) {
  const auto table = read_table(source.text);
  if (!table) return table.error();
  if (found.buses.empty()) found.buses.emplace_back();
  if (table->rows.empty()) return std::nullopt;
  const Columns columns(table->rows.front(), kKepwareColumns);
  if (!columns.has(Field::kName) || !columns.has(Field::kAddress))
    return "no columns 'Tag Name' and 'Address' in its first row";
  Device& device = found.buses.front().devices.emplace_back();
  device.name = stem_of(source.file);
  for (const Row& row : std::span(table->rows).subspan(1)) {
    Point point;
    point.name = columns.cell(row, Field::kName);
    point.origin = {source.file, row.line};
    if (auto fault = TagRow(columns, row, options).read(point, device.points))
      found.refuse(point.name, point.origin, std::move(*fault));
  }
  // Lists of other families use their driver's order and base.
  for (const Point& point : device.points)
    wide |=
        options.is_modbus() && point.type != ValueType::kString && registers_of(point.type, 0) > 1;
  if (options.is_modbus() && !options.base)
    found.guesses.push_back(
        {source.file, 1,
         "400001 is register 0 where the setting Zero-Based Addressing of the device is on, as the "
         "driver has it by default"});
  for (const std::string& title : columns.ignored()) {
    if (!is_one_of(column_word(title), kWithoutMeaning))
      found.note("{}: column '{}' is not used", source.file, title);
  }
  return std::nullopt;
}

Read read_kepware(Sources sources, const ReadOptions& options) {
  bool wide = false;
  auto found = read_each(sources, [&](const SourceText& source, Found& all) {
    return read_tags(source, options, all, wide);
  });
  if (found && wide && !options.word_order)
    found->note(
        "values of 32 and 64 bits have their low word first, as the driver has it where nobody "
        "changed it; where the device's page Data Encoding says otherwise: --word-order "
        "big-endian");
  return found;
}

}  // namespace

constinit const Format kKepwareFormat{"kepware", "Kepware tag export (CSV)", recognise_kepware,
                                      read_kepware};

}  // namespace fieldcast::importing

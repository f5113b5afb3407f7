// Tag lists of KEPServerEX and related products. Word order and address base are not in the list;
// the driver's defaults are assumed.
//
// Source: Kepware, feature page CSV import and export (columns); Modbus driver help (addresses,
// data types); Modbus device defaults from github.com/atc-net/atc-kepware: zero-based addressing,
// first word low, first double word low.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/import/formats/format.hpp"
#include "tools/import/formats/kepware_family.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr ColumnName kKepwareColumns[] = {
    {"tagname", Field::kName},        {"address", Field::kAddress},
    {"datatype", Field::kType},       {"clientaccess", Field::kAccess},
    {"scanrate", Field::kRefresh},    {"scaling", Field::kScaling},
    {"rawlow", Field::kRawLow},       {"rawhigh", Field::kRawHigh},
    {"scaledlow", Field::kScaledLow}, {"scaledhigh", Field::kScaledHigh},
    {"clamplow", Field::kClampLow},   {"clamphigh", Field::kClampHigh},
    {"engunits", Field::kUnit},       {"description", Field::kDescription},
    {"negatevalue", Field::kNegate}};
// Columns without a counterpart in a channel.
constexpr std::string_view kWithoutMeaning[] = {"respectdatatype", "scaleddatatype"};

constexpr unsigned kMaxArray = 1000;

// "400001", "40001.5", "H400A1", "400001[10]", "400001[2][5]", "400010.20H" of a string.
struct KepwareAddress {
  Reference reference;
  unsigned elements = 0;  // 0: not an array
  std::uint16_t string_bytes = 0;
  bool low_first = false;  // of a string
};
using ParsedKepware = tl::expected<KepwareAddress, std::string>;

tl::expected<unsigned, std::string> elements_of(std::string_view brackets) {
  unsigned elements = 1;
  while (!brackets.empty()) {
    const std::size_t end = brackets.find(']');
    const auto count = brackets.starts_with('[') && end != std::string_view::npos
                           ? whole_from(brackets.substr(1, end - 1))
                           : std::nullopt;
    if (!count || *count == 0 || *count > kMaxArray || elements * *count > kMaxArray)
      return tl::unexpected(fmt::format("'{}' is no array of 1 to {}", brackets, kMaxArray));
    elements *= static_cast<unsigned>(*count);
    brackets = trimmed(brackets.substr(end + 1));
  }
  return elements;
}

// "H400A1": hexadecimal after the digit of the area, counted from `base`.
ParsedKepware hexadecimal(std::string_view text, unsigned base) {
  if (text.empty()) return tl::unexpected(std::string("'H' is no address"));
  const auto digits = whole_from(fmt::format("0x{}", text.substr(1)));
  constexpr std::string_view kAreas = "0134";
  const std::size_t area = kAreas.find(text[0]);
  if (!digits || area == std::string_view::npos || *digits < base || *digits > 65535 + base)
    return tl::unexpected(fmt::format("'H{}' is no address", text));
  return KepwareAddress{
      {static_cast<ModbusArea>(area), static_cast<std::uint32_t>(*digits - base), {}}};
}

ParsedKepware string_address(std::string_view text, std::size_t point, unsigned base) {
  std::string_view length = text.substr(point + 1);
  KepwareAddress address;
  if (length.ends_with('L') || length.ends_with('l')) address.low_first = true;
  if (address.low_first || length.ends_with('H') || length.ends_with('h')) length.remove_suffix(1);
  const auto bytes = whole_from(length);
  if (!bytes || *bytes == 0 || *bytes > kMaxStringBytes)
    return tl::unexpected(
        fmt::format("a text of '{}' bytes; 1 to {} can be read", length, kMaxStringBytes));
  auto reference = reference_from(text.substr(0, point), base);
  if (!reference) return tl::unexpected(reference.error());
  address.reference = *reference;
  address.string_bytes = static_cast<std::uint16_t>(*bytes);
  return address;
}

ParsedKepware kepware_address(std::string_view text, bool is_string, unsigned base) {
  text = trimmed(text);
  unsigned elements = 0;
  if (const std::size_t bracket = text.find('['); bracket != std::string_view::npos) {
    const auto count = elements_of(text.substr(bracket));
    if (!count) return tl::unexpected(count.error());
    elements = *count;
    text = trimmed(text.substr(0, bracket));
  }
  ParsedKepware parsed;
  if (text.starts_with('H') || text.starts_with('h')) {
    parsed = hexadecimal(text.substr(1), base);
  } else if (const std::size_t point = text.find('.');
             is_string && point != std::string_view::npos) {
    parsed = string_address(text, point, base);
  } else {
    auto reference = reference_from(text, base);
    if (!reference) return tl::unexpected(reference.error());
    parsed = KepwareAddress{*reference};
  }
  if (parsed && !parsed->reference.area)
    return tl::unexpected(
        fmt::format("'{}' does not begin with 0, 1, 3 or 4 of a Modbus area; "
                    "for a driver of another family say --protocol",
                    text));
  if (parsed) parsed->elements = elements;
  return parsed;
}

class KepwareReader {
 public:
  KepwareReader(const SourceText& source, const ReadOptions& options, const Columns& columns)
      : source_(source), options_(options), columns_(columns) {}

  // Lists of other families use their driver's order and need no note about it.
  [[nodiscard]] bool is_modbus() const {
    return options_.protocol.empty() || options_.protocol.starts_with("modbus");
  }

  void read_row(const Row& row, Device& device, std::vector<Refusal>& refusals) {
    Point point;
    point.name = columns_.cell(row, Field::kName);
    point.origin = {source_.file, row.line};
    if (const auto fault = read_point(row, point, device.points))
      refusals.push_back({point.name, point.origin, *fault});
  }

 private:
  using MayFail = std::optional<std::string>;

  MayFail read_point(const Row& row, Point& point, std::vector<Point>& points) {
    if (point.name.empty()) return "the tag has no name";
    std::string type = lower(columns_.cell(row, Field::kType));
    const bool array = type.ends_with(" array");
    if (array) type.resize(type.size() - 6);
    if (type == "date") return "dates are no type of a channel";
    read_words(row, point);
    if (const auto fault = read_scaling(row, point)) return fault;
    if (!is_modbus()) return other_family(row, type, point, points);
    const auto address = kepware_address(columns_.cell(row, Field::kAddress), type == "string",
                                         options_.base.value_or(1));
    if (!address) return address.error();
    const ModbusArea area = *address->reference.area;
    if (const auto fault = read_type(type, *address, area, point)) return fault;
    if (!can_be_written(area)) point.access = Access::kReadOnly;
    if (array && address->elements == 0) return "an array without a number of elements";
    point.at = address_text(area, address->reference.first, address->reference.bit);
    if (address->elements == 0) {
      points.push_back(std::move(point));
    } else {
      append_array(points, point, area, address->reference.first, address->elements);
    }
    return std::nullopt;
  }

  MayFail other_family(const Row& row, const std::string& type, const Point& point,
                       std::vector<Point>& points) {
    const auto moved = append_family_point(options_.protocol, columns_.cell(row, Field::kAddress),
                                           type, point, points);
    return moved ? MayFail() : moved.error();
  }

  void read_words(const Row& row, Point& point) const {
    point.unit = columns_.cell(row, Field::kUnit);
    point.description = columns_.cell(row, Field::kDescription);
    const std::string access = column_word(columns_.cell(row, Field::kAccess));
    if (access == "rw" || access == "readwrite" || access.empty())
      point.access = Access::kReadWrite;
    if (access == "wo" || access == "writeonly") point.access = Access::kWriteOnly;
    const auto rate = number_from(columns_.cell(row, Field::kRefresh));
    if (rate && *rate > 0 && *rate < 1e10)
      point.refresh = std::chrono::microseconds{static_cast<std::int64_t>(*rate * 1000)};
  }

  MayFail read_scaling(const Row& row, Point& point) const {
    const std::string scaling = column_word(columns_.cell(row, Field::kScaling));
    const auto negate = whole_from(columns_.cell(row, Field::kNegate));
    if (scaling == "squareroot")
      return "square-root scaling: a channel scales linearly; without the scaling in the list "
             "the raw value can be moved";
    if (!scaling.empty() && scaling != "none") {
      if (scaling != "linear") return fmt::format("scaling '{}' is unknown", scaling);
      const auto raw_low = number_from(columns_.cell(row, Field::kRawLow));
      const auto raw_high = number_from(columns_.cell(row, Field::kRawHigh));
      const auto low = number_from(columns_.cell(row, Field::kScaledLow));
      const auto high = number_from(columns_.cell(row, Field::kScaledHigh));
      if (!raw_low || !raw_high || !low || !high || *raw_low == *raw_high)
        return "linear scaling without its four numbers";
      point.scale = (*high - *low) / (*raw_high - *raw_low);
      point.offset = *low - *raw_low * point.scale;
      if (point.scale == 0) return "linear scaling to one single value";
      for (const auto& [field, text] :
           {std::pair{Field::kClampLow, "below"}, std::pair{Field::kClampHigh, "above"}}) {
        if (whole_from(columns_.cell(row, field)) == 1u)
          point.changes.push_back(
              fmt::format("values {} the scaled range are shown as they are, "
                          "not clamped",
                          text));
      }
    }
    if (negate == 1u) {
      point.scale = -point.scale;
      point.offset = point.offset == 0 ? 0 : -point.offset;
    }
    return std::nullopt;
  }

  MayFail read_type(const std::string& type, const KepwareAddress& address, ModbusArea area,
                    Point& point) const {
    const bool bit = holds_bits(area) || address.reference.bit.has_value();
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
      if (address.low_first) point.byte_order = ByteOrder::kLittleEndian;
    } else if (point.type == ValueType::kInt8 || point.type == ValueType::kUint8) {
      point.byte = 0;
    } else if (registers_of(point.type, 0) > 1) {
      point.word_order = options_.word_order.value_or(WordOrder::kLittleEndian);
    }
    return std::nullopt;
  }

  const SourceText& source_;
  const ReadOptions& options_;
  const Columns& columns_;
};

std::vector<std::string> with_meaning(const std::vector<std::string>& titles) {
  std::vector<std::string> left;
  for (const std::string& title : titles) {
    if (std::ranges::find(kWithoutMeaning, column_word(title)) == std::end(kWithoutMeaning))
      left.push_back(title);
  }
  return left;
}

}  // namespace

Confidence recognise_kepware(const SourceText& source) {
  const auto table = read_table(source.text.substr(0, source.text.find('\n', 200)));
  if (!table || table->rows.empty()) return 0;
  const Columns columns(table->rows.front(), kKepwareColumns);
  const bool named = columns.has(Field::kName) && columns.has(Field::kAddress);
  if (!named) return 0;
  return columns.known() >= 5 ? kCertain : columns.known() >= 3 ? kLikely : 0;
}

Read read_kepware(std::span<const SourceText> sources, const ReadOptions& options) {
  Found found;
  Bus& bus = found.buses.emplace_back();
  bool wide = false;
  for (const SourceText& source : sources) {
    const auto table = read_table(source.text);
    if (!table) return tl::unexpected(fmt::format("{}: {}", source.file, table.error()));
    if (table->rows.empty()) continue;
    const Columns columns(table->rows.front(), kKepwareColumns);
    if (!columns.has(Field::kName) || !columns.has(Field::kAddress))
      return tl::unexpected(
          fmt::format("{}: no columns 'Tag Name' and 'Address' in its first row", source.file));
    Device& device = bus.devices.emplace_back();
    device.name = stem_of(source.file);
    KepwareReader reader(source, options, columns);
    for (std::size_t i = 1; i < table->rows.size(); ++i)
      reader.read_row(table->rows[i], device, found.refusals);
    for (const Point& point : device.points)
      wide |=
          reader.is_modbus() && point.type != ValueType::kString && registers_of(point.type, 0) > 1;
    if (reader.is_modbus() && !options.base)
      found.guesses.push_back(
          {source.file, 1,
           "400001 is register 0 where the setting Zero-Based Addressing of the "
           "device is on, as the driver has it by default"});
    for (const std::string& title : with_meaning(columns.ignored()))
      found.notes.push_back(fmt::format("{}: column '{}' is not used", source.file, title));
  }
  if (wide && !options.word_order)
    found.notes.push_back(
        "values of 32 and 64 bits have their low word first, as the driver has it where nobody "
        "changed it; where the device's page Data Encoding says otherwise: --word-order "
        "big-endian");
  return found;
}

}  // namespace fieldcast::importing

// Register lists of vendors and of people: one row for each value, the titles in many words and in
// any order (modbus_list_columns.cpp).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/number_text.hpp"
#include "tools/import/address.hpp"
#include "tools/import/columns.hpp"
#include "tools/import/formats/length_vote.hpp"
#include "tools/import/formats/list_address.hpp"
#include "tools/import/formats/list_columns.hpp"
#include "tools/import/formats/list_factor.hpp"
#include "tools/import/formats/list_order.hpp"
#include "tools/import/formats/list_overlap.hpp"
#include "tools/import/formats/list_type.hpp"
#include "tools/import/formats/modbus_list_columns.hpp"
#include "tools/import/formats/readers.hpp"
#include "tools/import/formats/reference_vote.hpp"
#include "tools/import/number.hpp"
#include "tools/import/types.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kTitleRows = 20;  // a title may stand above the header row

// The row that names the columns: the first one with an address and three names that are known.
std::optional<std::size_t> header_row(const Table& table) {
  for (std::size_t i = 0; i < std::min<std::size_t>(table.rows.size(), kTitleRows); ++i) {
    const Columns columns = list_columns(table.rows[i]);
    if (columns.has(Field::kAddress) && columns.known() >= 3) return i;
  }
  return std::nullopt;
}

class ListReader {
 public:
  ListReader(const SourceText& source, const ReadOptions& options, const Table& table,
             std::size_t header)
      : source_(source),
        options_(options),
        table_(table),
        header_(header),
        list_(table, header),
        columns_(list_.columns),
        base_(options.base ? options.base : list_.counts_from),
        length_unit_(list_.length_unit) {}

  void read(Bus& bus, Found& found) {
    for (std::size_t i = header_ + 1; i < table_.rows.size(); ++i) {
      const Row& row = table_.rows[i];
      if (columns_.cell(row, Field::kAddress).empty() && known_cells(row) < 2) continue;  // a title
      Entry& entry = entries_.emplace_back(Entry{.row = &row});
      entry.point.name = name_of(row);
      entry.point.origin = {source_.file, row.line};
      entry.fault = read_cells(entry);
    }
    doubt_bare_numbers();
    decide_lengths();
    for (Entry& entry : entries_) {
      if (!entry.fault) entry.fault = set_width(entry);
    }
    decide_references(found);
    std::vector<Placed> placed;
    for (Entry& entry : entries_) {
      if (!entry.fault) entry.fault = place(entry, placed);
    }
    note_overlaps(std::move(placed));
    for (Entry& entry : entries_) {
      Point& point = entry.point;
      if (entry.fault) {
        found.refusals.push_back({point.name, point.origin, *entry.fault});
      } else {
        device_of(entry, bus).points.push_back(std::move(point));
      }
    }
    for (const std::string& title : columns_.ignored())
      found.notes.push_back(fmt::format("{}: column '{}' is not used", source_.file, title));
    tell_decisions(found);
    tell_base(found);
    if (took_unsigned_)
      found.notes.push_back(fmt::format(
          "{}: values without a data type are taken for unsigned numbers", source_.file));
    if (took_holding_)
      found.notes.push_back(
          fmt::format("{}: no function code: addresses without one are taken for holding registers",
                      source_.file));
  }

 private:
  using MayFail = std::optional<std::string>;

  // A row while the list is read. One with a fault takes part in no decision about the others.
  struct Entry {
    const Row* row = nullptr;
    Point point{};
    ListAddress address{};
    std::optional<ModbusArea> said{};     // by the function or the table
    std::optional<std::uint16_t> unit{};  // the address of its device
    ListType type{};
    std::optional<Length> length{};
    bool no_type = false;  // the cell names none
    MayFail fault{};
  };

  [[nodiscard]] std::size_t known_cells(const Row& row) const {
    std::size_t filled = 0;
    for (const std::string& cell : row.cells) filled += !cell.empty();
    return filled;
  }

  [[nodiscard]] std::string name_of(const Row& row) const {
    for (const Field field : {Field::kName, Field::kDescription, Field::kAddress}) {
      if (const auto cell = columns_.cell(row, field); !cell.empty()) return std::string(cell);
    }
    return {};
  }

  Device& device_of(const Entry& entry, Bus& bus) const {
    const auto address = entry.unit;
    for (Device& device : bus.devices) {
      if (device.address == address && device.name.starts_with(stem_of(source_.file)))
        return device;
    }
    Device& device = bus.devices.emplace_back();
    device.address = address;
    device.name = stem_of(source_.file) + (address ? fmt::format("-{}", *address) : "");
    return device;
  }

  // What the row says by itself.
  MayFail read_cells(Entry& entry) {
    const Row& row = *entry.row;
    const auto address = list_address_from(columns_.cell(row, Field::kAddress),
                                           {list_.hex, options_.base.value_or(1)});
    if (!address) {
      entry.point.origin.column =
          static_cast<unsigned>(columns_.index_of(Field::kAddress).value_or(0)) + 1;
      return address.error();
    }
    entry.address = *address;
    if (base_ == 0u && address->is_open()) entry.address.reference.reset();
    if (base_ == 1u && address->plain) {
      if (*address->plain == 0) return "the addresses of the list count from 1";
      entry.address.plain = *address->plain - 1;
    }
    const std::string_view type_cell = columns_.cell(row, Field::kType);
    const std::string_view area_cell = columns_.cell(row, Field::kArea);
    entry.said = area_by_name(area_cell);
    if (!entry.said && !is_blank(area_cell))
      return fmt::format("table or function '{}' is not understood", area_cell);
    const auto type = list_type_from(type_cell);
    if (!type) return type.error();
    entry.type = *type;
    // One cell of a column of types may name the table.
    if (!entry.said && !type->type && is_area_word(type_cell)) entry.said = area_by_name(type_cell);
    const auto length = length_from(columns_.cell(row, Field::kLength));
    if (!length) return length.error();
    entry.length = *length;
    if (const std::string_view cell = columns_.cell(row, Field::kBit); !is_blank(cell)) {
      const auto bit = whole_from(cell);
      if (!bit || *bit > 15) return fmt::format("bit '{}' is not 0 to 15", cell);
      entry.address.bit = static_cast<std::uint8_t>(*bit);
    }
    if (const auto fault = read_unit(entry)) return fault;
    if (const auto& reference = entry.address.reference;
        reference && !entry.address.plain && entry.said && *entry.said != *reference->area)
      return contradiction(entry);
    return std::nullopt;
  }

  // Words, bytes or bits: all rows that are understood tell.
  void decide_lengths() {
    if (length_unit_ || !columns_.has(Field::kLength)) return;
    LengthVote vote;
    std::map<std::string, std::map<std::uint32_t, const Entry*>> places;
    for (const Entry& entry : entries_) {
      if (entry.fault) continue;
      const bool explicit_width = entry.type.type && !entry.type.open;
      // Of a byte, "1" may be its register too.
      if (entry.length && explicit_width && bits_of(*entry.type.type) > 8)
        vote.add_type(*entry.length, bits_of(*entry.type.type));
      const std::string where = fmt::format("{}/{}", entry.unit.value_or(0),
                                            entry.said ? static_cast<int>(*entry.said) : -1);
      const auto& address = entry.address;
      places[where].try_emplace(address.plain ? *address.plain : address.reference->first, &entry);
    }
    for (const auto& [where, entries] : places) {
      for (auto it = entries.begin(); std::next(it) != entries.end(); ++it) {
        if (it->second->length)
          vote.add_step(*it->second->length, std::next(it)->first - it->first);
      }
    }
    length_unit_ = vote.unit();
  }

  // How many bits the row says besides its type; nothing: it does not.
  std::optional<unsigned> said_bits(Entry& entry) const {
    if (entry.type.bits > 0) return entry.type.bits;
    if (entry.length) {
      const Length& length = *entry.length;
      if (const auto unit = length.unit ? length.unit : length_unit_; unit) {
        // "64" among "16 bits" and "32 bits", though other rows count otherwise.
        const bool fits = length.bits(*unit) <= 64 || !entry.type.open;
        if (fits || length.unit || length.number > 64) return length.bits(*unit);
        return length.number;
      }
      if (length.number == 16 || length.number == 32 || length.number == 64) {
        const bool text = entry.type.type && entry.type.type->type == ValueType::kString;
        if (!text) return length.number;
      }
      if (entry.type.open || !entry.type.type || bits_of(*entry.type.type) == 0)
        entry.point.changes.push_back(
            fmt::format("length {} is taken as registers", length.number));
      return length.bits(LengthUnit::kWords);
    }
    if (entry.address.registers > 0) return entry.address.registers * 16;
    return std::nullopt;
  }

  // The type as wide as the row says.
  MayFail set_width(Entry& entry) {
    auto& type = entry.type.type;
    if (type && type->type == ValueType::kBool) return std::nullopt;
    const auto bits = said_bits(entry);
    if (!type) {
      entry.no_type = true;
      type = TypeName{};
      entry.type.open = true;
    }
    if (!bits) return std::nullopt;
    if (entry.no_type && *bits == 1) {
      entry.no_type = false;
      type->type = ValueType::kBool;
      return std::nullopt;
    }
    if (entry.type.open) {
      const auto wide = as_wide(type->type, *bits);
      if (!wide && !entry.no_type)
        return fmt::format("no '{}' has {} bits", columns_.cell(*entry.row, Field::kType), *bits);
      if (!wide) return fmt::format("no data type, and no number has {} bits", *bits);
      type->type = *wide;
      return std::nullopt;
    }
    const unsigned own = bits_of(*type);
    if (own == 0) {
      const unsigned bytes = *bits / 8;
      if (bytes == 0 || bytes > kMaxStringBytes) return kTextLength;
      type->string_bytes = static_cast<std::uint16_t>(bytes);
    } else if ((own + 15) / 16 != (*bits + 15) / 16) {
      entry.point.changes.push_back(fmt::format("the type '{}' is taken, which {} bits do not fit",
                                                columns_.cell(*entry.row, Field::kType), *bits));
    }
    return std::nullopt;
  }
  static constexpr const char* kTextLength = "a text without a length of 1 to 125 registers";

  // A blank cell below a filled one: a spreadsheet had merged them.
  MayFail read_unit(Entry& entry) {
    const std::string_view cell = columns_.cell(*entry.row, Field::kDevice);
    if (is_blank(cell)) {
      if (odd_unit_) return "no address of its device, and that of the row above is odd";
      entry.unit = last_unit_;
      if (last_unit_ && !merged_) merged_ = entry.row->line;
      return std::nullopt;
    }
    const auto unit = whole_from(cell);
    odd_unit_ = !unit || *unit > 255;
    if (odd_unit_) return fmt::format("'{}' is no address of a device", cell);
    last_unit_ = entry.unit = static_cast<std::uint16_t>(*unit);
    return std::nullopt;
  }

  // Of a list whose addresses are marked ("0x10", "10h") a bare number may be of either kind.
  void doubt_bare_numbers() {
    const auto understood = [](const Entry& entry) { return !entry.fault; };
    const auto is_bare = [](const Entry& entry) {
      return !entry.address.marked_hex && entry.address.plain && !entry.address.reference;
    };
    if (list_.hex || std::ranges::none_of(entries_, [&](const Entry& entry) {
          return understood(entry) && entry.address.marked_hex;
        }))
      return;
    for (Entry& entry : entries_) {
      if (!understood(entry) || !is_bare(entry)) continue;
      const std::string_view cell = columns_.cell(*entry.row, Field::kAddress);
      if (cell.size() > 1 && cell[0] == '0') {
        entry.fault = fmt::format("address '{}' may be hexadecimal, as others of the list", cell);
      } else {
        entry.point.changes.push_back(
            fmt::format("address '{}' is read as decimal, others are hexadecimal", cell));
      }
    }
  }

  void tell_decisions(Found& found) const {
    const auto tell = [&](std::string_view text) {
      found.notes.push_back(fmt::format("{}: {}", source_.file, text));
    };
    if (!list_.hex_note.empty()) tell(list_.hex_note);
    if (merged_)
      tell(
          fmt::format("rows without an address of their device (line {}, ..) are taken to have "
                      "that of the row above",
                      *merged_));
    if (list_.gain == ListColumns::Gain::kDivides)
      tell("column 'Gain': raw values are divided by it");
    if (list_.gain == ListColumns::Gain::kMultiplies)
      tell("column 'Gain': raw values are multiplied by it, for it is below 1");
  }

  void tell_base(Found& found) const {
    if (list_.counts_from && base_ != list_.counts_from)
      found.notes.push_back(
          fmt::format("{}: the addresses count from {} by --base, not from {} as {}", source_.file,
                      *base_, *list_.counts_from, list_.counts_note));
    if (options_.base) return;
    if (base_) {
      found.notes.push_back(fmt::format("{}: the addresses count from {}, as {}", source_.file,
                                        *base_, list_.counts_note));
      return;
    }
    BaseGuess guess{source_.file, 0,
                    "no title, no digit of a table and no second column says more"};
    for (const Entry& entry : entries_) {
      const std::string_view cell = columns_.cell(*entry.row, Field::kAddress);
      if (entry.fault || cell.empty()) continue;
      if (entry.address.plain == 0u) {
        guess.reason = fmt::format("the list has an address 0 (line {})", entry.row->line);
        break;
      }
      const bool reference = entry.address.reference && cell[0] >= '0' && cell[0] <= '9' &&
                             (counts_from_one_ || !entry.address.plain);
      if (!reference) continue;
      guess.base = 1;
      guess.reason = fmt::format(
          "'{}' (line {}) begins with the digit of its table, and such references count from 1",
          cell, entry.row->line);
      break;
    }
    found.guesses.push_back(std::move(guess));
  }

  [[nodiscard]] std::string contradiction(const Entry& entry) const {
    return fmt::format("the address '{}' and '{}' name different tables",
                       columns_.cell(*entry.row, Field::kAddress),
                       columns_.cell(*entry.row, Field::kArea));
  }

  // "40001" may be the first holding register, or register 40001: the whole list tells.
  void decide_references(Found& found) {
    ReferenceVote vote;
    for (const Entry& entry : entries_) {
      if (entry.fault || !entry.address.plain) continue;
      vote.add({.line = entry.row->line,
                .cell = columns_.cell(*entry.row, Field::kAddress),
                .reference = entry.address.is_open() ? entry.address.reference->area : std::nullopt,
                .said = entry.said,
                .is_number = !entry.no_type && is_number(entry.type.type->type)});
    }
    counts_from_one_ = vote.counts_from_one();
    for (Entry& entry : entries_) {
      if (counts_from_one_ && !entry.fault && entry.address.is_open() && entry.said &&
          *entry.said != *entry.address.reference->area)
        entry.fault = contradiction(entry);
    }
    if (const std::string note = vote.note(); !note.empty())
      found.notes.push_back(fmt::format("{}: {}", source_.file, note));
  }

  // The address as the whole list has it, and the type that depends on it.
  MayFail place(Entry& entry, std::vector<Placed>& placed) {
    const ListAddress& address = entry.address;
    Reference reference;
    if (address.reference && (counts_from_one_ || !address.plain)) {
      reference = *address.reference;
    } else {
      reference.area = entry.said;
      reference.first = *address.plain;
    }
    reference.bit = address.bit;
    if (!reference.area) {
      took_holding_ = true;
      reference.area = ModbusArea::kHolding;
    }
    if (const auto fault = read_point(entry, reference)) return fault;
    const Point& point = entry.point;
    placed.push_back({.device = entry.unit,
                      .area = *reference.area,
                      .first = reference.first,
                      .bit = point.type == ValueType::kBool ? reference.bit : std::nullopt,
                      .registers = holds_bits(*reference.area)
                                       ? 1
                                       : registers_of(point.type, point.string_bytes),
                      .point = &entry.point});
    return std::nullopt;
  }

  MayFail read_point(Entry& entry, Reference reference) {
    const Row& row = *entry.row;
    Point& point = entry.point;
    const ModbusArea area = *reference.area;
    if (const auto fault = check_bit(entry, reference)) return fault;
    if (const auto fault = read_type(entry, reference, point)) return fault;
    point.at = address_text(area, reference.first, reference.bit);
    point.unit = columns_.cell(row, Field::kUnit);
    if (point.unit == "-" || point.unit == "--") point.unit.clear();
    if (columns_.has(Field::kName)) point.description = columns_.cell(row, Field::kDescription);
    const std::string_view access_cell = columns_.cell(row, Field::kAccess);
    const auto access = access_from(access_cell);
    if (!access)
      point.changes.push_back(fmt::format("access '{}' is not understood: read-only", access_cell));
    if (can_be_written(area)) point.access = access.value_or(Access::kReadOnly);
    const std::string_view refresh_cell = columns_.cell(row, Field::kRefresh);
    const auto refresh = number_from(refresh_cell);
    if (refresh && *refresh > 0 && *refresh < 1e9) {
      point.refresh = std::chrono::microseconds{static_cast<std::int64_t>(*refresh * 1000)};
    } else if (!is_blank(refresh_cell)) {
      point.changes.push_back(fmt::format("refresh '{}' is no number of ms", refresh_cell));
    }
    if (const auto fault = read_scale(row, point)) return fault;
    read_scale_beside(row, point);
    return std::nullopt;
  }

  // Reads the scale from the unit or the remarks if the row has no column for it.
  void read_scale_beside(const Row& row, Point& point) const {
    const bool scaled =
        std::ranges::any_of(std::array{Field::kScale, Field::kDivisor, Field::kDecimals},
                            [&](Field field) { return !is_blank(columns_.cell(row, field)); });
    const std::optional<double> weight = weight_from(columns_.cell(row, Field::kDescription));
    const auto factor = factor_of_unit(point.unit, list_.style);
    if (weight && !scaled) {
      point.scale = 1 / *weight;
      point.changes.push_back(
          fmt::format("the value weight {} of the remark divides the raw value", *weight));
    } else if (factor && !scaled && point.type != ValueType::kString) {
      point.changes.push_back(fmt::format("unit '{}' is taken for the scale {}", point.unit,
                                          number_text(factor->value)));
      point.scale = factor->value;
      point.unit = factor->unit;
    } else if (holds_factor(point.unit)) {
      point.changes.push_back(
          fmt::format("unit '{}' holds a number, which is no part of the scale", point.unit));
    }
  }

  // "40001.0" of a number is no bit: a spreadsheet wrote the address with a decimal.
  MayFail check_bit(const Entry& entry, Reference& reference) const {
    const std::string_view name = columns_.cell(*entry.row, Field::kType);
    const bool number = !entry.no_type && entry.type.type->type != ValueType::kBool;
    if (!number) return std::nullopt;
    if (holds_bits(*reference.area))
      return fmt::format("data type '{}' in a table of single bits", name);
    if (!reference.bit) return std::nullopt;
    if (*reference.bit != 0 || !columns_.cell(*entry.row, Field::kBit).empty())
      return fmt::format("data type '{}' at a single bit", name);
    reference.bit.reset();
    return std::nullopt;
  }

  MayFail read_type(const Entry& entry, const Reference& reference, Point& point) {
    const bool bit = holds_bits(*reference.area) || reference.bit;
    const TypeName type = bit ? TypeName{.type = ValueType::kBool} : *entry.type.type;
    took_unsigned_ = took_unsigned_ || (entry.no_type && !bit);
    point.type = type.type;
    point.byte = type.byte;
    if ((point.type == ValueType::kInt8 || point.type == ValueType::kUint8) && !point.byte)
      point.byte = 0;
    if (point.type == ValueType::kBool && !bit) return "a bit of a register without its number";
    if (point.type == ValueType::kString) {
      if (type.string_bytes == 0) return kTextLength;
      point.string_bytes = type.string_bytes;
    }
    return read_order(*entry.row, type, point);
  }

  MayFail read_order(const Row& row, const TypeName& type, Point& point) const {
    if (point.type == ValueType::kBool) return std::nullopt;
    const std::string_view cell = columns_.cell(row, Field::kWordOrder);
    const auto title = columns_.index_of(Field::kWordOrder);
    const bool of_bytes =
        title && column_word(table_.rows[header_].cell(*title)).find("byte") != std::string::npos;
    const auto order = list_order_from(cell, of_bytes);
    if (!order) return order.error();
    const bool wide = registers_of(point.type, point.string_bytes) > 1;
    if (wide && order->words && type.word_order && *order->words != *type.word_order)
      return fmt::format("order '{}' and data type '{}' say different orders", cell,
                         columns_.cell(row, Field::kType));
    const auto words = type.word_order ? type.word_order : order->words;
    const auto bytes = type.byte_order ? type.byte_order : order->bytes;
    if (wide && point.type != ValueType::kString)
      point.word_order = words.value_or(options_.word_order.value_or(WordOrder::kBigEndian));
    point.byte_order = bytes.value_or(ByteOrder::kBigEndian);
    if (wide && order->little_alone && !bytes)
      point.changes.push_back(fmt::format("order '{}' is taken for: low word first", cell));
    return std::nullopt;
  }

  static bool is_blank(std::string_view cell) { return cell.empty() || cell == "-"; }

  // "0.1kWh", "V x10", "1/10 V"; not "1/min", "m3".
  static bool holds_factor(std::string_view unit) {
    const auto is_numeral = [](char c) { return c >= '0' && c <= '9'; };
    if (unit.starts_with("1/") && unit.size() > 2 && !is_numeral(unit[2])) return false;
    const std::size_t sign = unit.find_first_of("xX*");
    const bool behind =
        sign != std::string_view::npos && sign + 1 < unit.size() && is_numeral(unit[sign + 1]);
    return behind || (!unit.empty() && is_numeral(unit[0]));
  }

  MayFail read_scale(const Row& row, Point& point) const {
    const std::string_view divisor = columns_.cell(row, Field::kDivisor);
    const std::string_view decimals = columns_.cell(row, Field::kDecimals);
    const auto factor = factor_from(columns_.cell(row, Field::kScale), list_.style);
    if (!factor) return "scale " + factor.error();
    if (*factor) {
      point.scale = (*factor)->value;
      if (const std::string& unit = (*factor)->unit; !unit.empty() && point.unit.empty()) {
        point.unit = unit;
      } else if (!unit.empty() && unit != point.unit) {
        return fmt::format("scale '{}' names another unit than '{}'",
                           columns_.cell(row, Field::kScale), point.unit);
      }
    }
    if (!is_blank(divisor)) {
      const auto number = factor_from(divisor, list_.style);
      if (!number) return "divisor " + number.error();
      if (*number && *factor && (*number)->value != 1)
        return "a scale and a divisor, of which one is too many";
      if (*number && list_.gain == ListColumns::Gain::kUnclear && (*number)->value != 1)
        return fmt::format(
            "gain '{}': others of the list are on the other side of 1, so that it "
            "is unclear whether to divide or to multiply",
            divisor);
      if (*number && !*factor)
        point.scale =
            list_.gain == ListColumns::Gain::kMultiplies ? (*number)->value : 1 / (*number)->value;
    }
    if (!is_blank(decimals)) {
      if (const auto fault = read_decimals(decimals, *factor || !is_blank(divisor), point))
        return fault;
    }
    const std::string_view offset = columns_.cell(row, Field::kOffset);
    if (!is_blank(offset)) {
      const auto number = number_from(offset);
      if (!number) return fmt::format("offset '{}' is no number", offset);
      point.offset = *number;
    }
    return std::nullopt;
  }

  // "2" places, or "0.01", which can only be the resolution.
  static MayFail read_decimals(std::string_view cell, bool scaled, Point& point) {
    double scale = 1;
    if (const auto digits = whole_from(cell);
        digits && cell.find_first_not_of("0123456789") == std::string_view::npos) {
      if (*digits > 12) return fmt::format("{} decimal places", *digits);
      scale = 1 / std::pow(10.0, static_cast<double>(*digits));
    } else {
      const auto number = number_from(cell);
      const double places = number && *number > 0 ? -std::log10(*number) : 0;
      if (places < 0.5 || std::abs(places - std::round(places)) > 1e-9)
        return fmt::format("decimals '{}' is no count of places", cell);
      scale = *number;
      if (!scaled)
        point.changes.push_back(fmt::format("decimals '{}' is taken for the resolution", cell));
    }
    if (!scaled) {
      point.scale = scale;
    } else if (scale != 1 && std::abs(point.scale / scale - 1) > 1e-9) {
      point.changes.push_back(fmt::format("decimals '{}' is left out, the scale is taken", cell));
    }
    return std::nullopt;
  }

  const SourceText& source_;
  const ReadOptions& options_;
  const Table& table_;
  std::size_t header_;
  const ListColumns list_;
  const Columns& columns_;
  const std::optional<unsigned> base_;  // of the addresses, as the user or the list says it
  std::vector<Entry> entries_;
  bool counts_from_one_ = false;
  std::optional<std::uint16_t> last_unit_;
  bool odd_unit_ = false;           // of the last row that has one
  std::optional<unsigned> merged_;  // the first line that has the unit of the row above
  bool took_holding_ = false;
  bool took_unsigned_ = false;
  std::optional<LengthUnit> length_unit_;  // of the numbers in the column of lengths
};

}  // namespace

Confidence recognise_modbus_list(const SourceText& source) {
  const auto table =
      read_table(std::string_view(source.text).substr(0, source.text.find('\n', 8192)));
  if (!table) return 0;
  const auto header = header_row(*table);
  if (!header || table->rows.size() < *header + 2) return 0;
  return list_columns(table->rows[*header]).known() >= 5 ? kLikely : kGuess;
}

Read read_modbus_list(std::span<const SourceText> sources, const ReadOptions& options) {
  Found found;
  Bus& bus = found.buses.emplace_back();
  for (const SourceText& source : sources) {
    const auto table = read_table(source.text);
    if (!table) return tl::unexpected(fmt::format("{}: {}", source.file, table.error()));
    const auto header = header_row(*table);
    if (!header)
      return tl::unexpected(fmt::format(
          "{}: none of its first {} rows names the columns: an address (Address, Register) and "
          "two more (Name, Type, Unit, Scale, Function, ..) are needed",
          source.file, kTitleRows));
    ListReader(source, options, *table, *header).read(bus, found);
  }
  return found;
}

}  // namespace fieldcast::importing

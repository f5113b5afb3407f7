// Register lists of vendors and of people: one row for each value, the titles in many words and in
// any order (modbus_list_columns.cpp).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/import/address.hpp"
#include "tools/import/columns.hpp"
#include "tools/import/formats/list_address.hpp"
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
    const Columns columns(table.rows[i], list_columns());
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
        columns_(table.rows[header], list_columns()) {
    const auto title = columns_.index_of(Field::kAddress);
    hex_ = title && column_word(table.rows[header].cell(*title)).find("hex") != std::string::npos;
  }

  void read(Bus& bus, Found& found) {
    for (std::size_t i = header_ + 1; i < table_.rows.size(); ++i) {
      const Row& row = table_.rows[i];
      if (columns_.cell(row, Field::kAddress).empty() && known_cells(row) < 2) continue;  // a title
      Entry& entry = entries_.emplace_back(Entry{.row = &row});
      entry.point.name = name_of(row);
      entry.point.origin = {source_.file, row.line};
      entry.fault = read_cells(entry);
    }
    decide_references(found);
    for (Entry& entry : entries_) {
      Point& point = entry.point;
      if (!entry.fault) entry.fault = place(entry);
      if (entry.fault) {
        found.refusals.push_back({point.name, point.origin, *entry.fault});
      } else {
        device_of(*entry.row, bus).points.push_back(std::move(point));
      }
    }
    for (const std::string& title : columns_.ignored())
      found.notes.push_back(fmt::format("{}: column '{}' is not used", source_.file, title));
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
    std::optional<ModbusArea> said{};  // by the function or the table
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

  Device& device_of(const Row& row, Bus& bus) {
    const auto unit = whole_from(columns_.cell(row, Field::kDevice));
    const auto address = unit && *unit <= 255
                             ? std::optional<std::uint16_t>(static_cast<std::uint16_t>(*unit))
                             : std::nullopt;
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
    const auto address = list_address_from(columns_.cell(row, Field::kAddress), hex_);
    if (!address) return address.error();
    entry.address = *address;
    entry.said = area_by_name(columns_.cell(row, Field::kArea));
    if (const auto bit = whole_from(columns_.cell(row, Field::kBit))) {
      if (*bit > 15) return fmt::format("bit {} is not 0 to 15", *bit);
      entry.address.bit = static_cast<std::uint8_t>(*bit);
    }
    if (const auto& reference = entry.address.reference;
        reference && !entry.address.plain && entry.said && *entry.said != *reference->area)
      return contradiction(entry);
    return std::nullopt;
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
      const auto type = type_by_name(columns_.cell(*entry.row, Field::kType));
      vote.add({.line = entry.row->line,
                .cell = columns_.cell(*entry.row, Field::kAddress),
                .reference = entry.address.is_open() ? entry.address.reference->area : std::nullopt,
                .said = entry.said,
                .is_number = type && is_number(type->type)});
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
  MayFail place(Entry& entry) {
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
    return read_point(*entry.row, reference, entry.point);
  }

  MayFail read_point(const Row& row, Reference reference, Point& point) {
    const ModbusArea area = *reference.area;
    if (const auto fault = check_bit(row, reference)) return fault;
    if (const auto fault = read_type(row, reference, point)) return fault;
    point.at = address_text(area, reference.first, reference.bit);
    point.unit = columns_.cell(row, Field::kUnit);
    if (point.unit == "-" || point.unit == "--") point.unit.clear();
    if (columns_.has(Field::kName)) point.description = columns_.cell(row, Field::kDescription);
    const std::string access = column_word(columns_.cell(row, Field::kAccess));
    if (can_be_written(area)) {
      if (access == "rw" || access == "readwrite" || access == "wr")
        point.access = Access::kReadWrite;
      if (access == "w" || access == "wo" || access == "writeonly" || access == "write")
        point.access = Access::kWriteOnly;
    }
    const auto refresh = number_from(columns_.cell(row, Field::kRefresh));
    if (refresh && *refresh > 0 && *refresh < 1e9)
      point.refresh = std::chrono::microseconds{static_cast<std::int64_t>(*refresh * 1000)};
    return read_scale(row, point);
  }

  // "40001.0" of a number is no bit: a spreadsheet wrote the address with a decimal.
  MayFail check_bit(const Row& row, Reference& reference) const {
    const auto type = type_by_name(columns_.cell(row, Field::kType));
    const bool number = type && type->type != ValueType::kBool;
    if (!reference.bit || !number || holds_bits(*reference.area)) return std::nullopt;
    if (*reference.bit != 0 || !columns_.cell(row, Field::kBit).empty())
      return fmt::format("data type '{}' at a single bit", columns_.cell(row, Field::kType));
    reference.bit.reset();
    return std::nullopt;
  }

  MayFail read_type(const Row& row, const Reference& reference, Point& point) const {
    const bool bit = holds_bits(*reference.area) || reference.bit;
    const std::string_view name = columns_.cell(row, Field::kType);
    const auto length = whole_from(columns_.cell(row, Field::kLength));
    auto type = type_by_name(name);
    // A type column may name the area, and the length alone the type.
    if (!type && (name.empty() || area_by_name(name)) && !bit)
      type = length == 2u   ? TypeName{.type = ValueType::kUint32}
             : length == 4u ? TypeName{.type = ValueType::kUint64}
                            : TypeName{.type = ValueType::kUint16};
    if (bit) type = TypeName{.type = ValueType::kBool};
    if (!type) return fmt::format("data type '{}' is unknown", name);
    point.type = type->type;
    point.byte = type->byte;
    if ((point.type == ValueType::kInt8 || point.type == ValueType::kUint8) && !point.byte)
      point.byte = 0;
    if (point.type == ValueType::kBool && !bit) return "a bit of a register without its number";
    if (point.type == ValueType::kString) {
      const std::uint64_t bytes = type->string_bytes != 0 ? type->string_bytes
                                  : length                ? *length * 2
                                                          : 0;
      if (bytes == 0 || bytes > kMaxStringBytes)
        return "a text without a length of 1 to 125 registers";
      point.string_bytes = static_cast<std::uint16_t>(bytes);
    }
    return read_order(row, *type, length, point);
  }

  MayFail read_order(const Row& row, const TypeName& type, std::optional<std::uint64_t> length,
                     Point& point) const {
    const std::string_view cell = columns_.cell(row, Field::kWordOrder);
    const auto letters = orders_by_letters(cell);
    if (letters && point.type != ValueType::kBool) {
      point.word_order = letters->words;
      point.byte_order = letters->bytes;
    } else if (!cell.empty()) {
      const std::string word = column_word(cell);
      if (word.starts_with("little") || word == "le" || word.starts_with("lsw") ||
          word.starts_with("lowword"))
        point.word_order = WordOrder::kLittleEndian;
    }
    if (type.word_order) point.word_order = *type.word_order;
    if (type.byte_order) point.byte_order = *type.byte_order;
    if (options_.word_order) point.word_order = *options_.word_order;
    const unsigned registers = registers_of(point.type, point.string_bytes);
    if (registers == 1) point.word_order = WordOrder::kBigEndian;
    // "INT" with a length of two registers is one of 32 bits.
    const bool whole = point.type == ValueType::kInt16 || point.type == ValueType::kUint16;
    const auto said = static_cast<unsigned>(length.value_or(0));
    if (whole && (said == 2 || said == 4)) {
      point.type = *integer_of(said * 16, point.type == ValueType::kInt16);
      if (options_.word_order) point.word_order = *options_.word_order;
    }
    return std::nullopt;
  }

  // "0.1", "x0.1", "1/10", "/10", "*0,01", "0.1 V"
  static std::optional<double> factor_from(std::string_view cell) {
    cell = trimmed(cell);
    while (!cell.empty() && std::string_view("xX*").find(cell[0]) != std::string_view::npos)
      cell = trimmed(cell.substr(1));
    if (const std::size_t stroke = cell.find_first_of("/:"); stroke != std::string_view::npos) {
      const auto above = stroke == 0 ? 1.0 : number_from(cell.substr(0, stroke));
      const auto below = number_from(cell.substr(stroke + 1));
      if (!above || !below || *below == 0) return std::nullopt;
      return *above / *below;
    }
    if (const auto number = number_from(cell)) return number;
    // "0.1 V", "0.1kWh"
    return number_from(cell.substr(0, cell.find_first_not_of("+-0123456789.,")));
  }

  MayFail read_scale(const Row& row, Point& point) const {
    const std::string_view scale = columns_.cell(row, Field::kScale);
    const std::string_view divisor = columns_.cell(row, Field::kDivisor);
    if (!scale.empty() && scale != "-") {
      const auto factor = factor_from(scale);
      if (!factor || *factor == 0) return fmt::format("scale '{}' is no number", scale);
      point.scale = *factor;
    } else if (!divisor.empty() && divisor != "-") {
      const auto number = number_from(divisor);
      if (!number || *number == 0) return fmt::format("divisor '{}' is no number", divisor);
      point.scale = 1 / *number;
    } else if (const auto digits = whole_from(columns_.cell(row, Field::kDecimals))) {
      if (*digits > 12) return fmt::format("{} decimal places", *digits);
      point.scale = 1 / std::pow(10.0, static_cast<double>(*digits));
    }
    if (const auto offset = number_from(columns_.cell(row, Field::kOffset))) point.offset = *offset;
    if (!is_number(point.type)) {
      point.scale = 1;
      point.offset = 0;
    }
    return std::nullopt;
  }

  const SourceText& source_;
  const ReadOptions& options_;
  const Table& table_;
  std::size_t header_;
  Columns columns_;
  std::vector<Entry> entries_;
  bool hex_ = false;  // the column of the addresses
  bool counts_from_one_ = false;
  bool took_holding_ = false;
};

}  // namespace

Confidence recognise_modbus_list(const SourceText& source) {
  const auto table =
      read_table(std::string_view(source.text).substr(0, source.text.find('\n', 8192)));
  if (!table) return 0;
  const auto header = header_row(*table);
  if (!header || table->rows.size() < *header + 2) return 0;
  return Columns(table->rows[*header], list_columns()).known() >= 5 ? kLikely : kGuess;
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

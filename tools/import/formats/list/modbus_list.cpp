// Register lists of vendors and of users: one row for each value, the titles in many words and in
// any order (list_columns.cpp).
#include <algorithm>
#include <map>

#include "tools/import/formats/format.hpp"
#include "tools/import/formats/list/list_point.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kTitleRows = 20;  // a title may stand above the header row

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
    first_device_ = bus.devices.size();
    for (const Row& row : std::span(table_.rows).subspan(header_ + 1)) {
      const auto filled = std::ranges::count_if(row.cells, std::not_fn(&std::string::empty));
      if (cell(row, Field::kAddress).empty() && filled < 2) continue;  // a title
      ListEntry& entry = entries_.emplace_back(ListEntry{.row = &row});
      entry.point.name = name_of(row);
      entry.point.origin = {source_.file, row.line};
      entry.fault = read_cells(entry);
    }
    doubt_bare_numbers();
    decide_lengths();
    for (ListEntry& entry : entries_) {
      if (!entry.fault) entry.fault = set_width(entry);
    }
    decide_references();
    std::vector<Placed> placed;
    for (ListEntry& entry : entries_) {
      if (!entry.fault) entry.fault = place(entry, placed);
    }
    note_overlaps(std::move(placed));
    for (ListEntry& entry : entries_) {
      Point& point = entry.point;
      if (entry.fault) {
        found.refuse(point.name, point.origin, *entry.fault);
      } else {
        device_of(entry, bus).points.push_back(std::move(point));
      }
    }
    for (const std::string& title : columns_.ignored()) tell("column '{}' is not used", title);
    tell_decisions();
    if (const auto guess = base_guess()) found.guesses.push_back(*guess);
    if (took_unsigned_) tell("values without a data type are taken for unsigned numbers");
    if (took_holding_)
      tell("no function code: addresses without one are taken for holding registers");
    for (const std::string& note : notes_) found.note("{}: {}", source_.file, note);
  }

 private:
  [[nodiscard]] std::string_view cell(const Row& row, Field field) const {
    return columns_.cell(row, field);
  }
  [[nodiscard]] std::string_view cell(const ListEntry& entry, Field field) const {
    return columns_.cell(*entry.row, field);
  }
  template <typename... Args>
  void tell(fmt::format_string<Args...> text, Args&&... args) {
    notes_.push_back(fmt::format(text, std::forward<Args>(args)...));
  }

  [[nodiscard]] std::string name_of(const Row& row) const {
    for (const Field field : {Field::kName, Field::kDescription, Field::kAddress}) {
      if (const auto text = cell(row, field); !text.empty()) return std::string(text);
    }
    return {};
  }

  Device& device_of(const ListEntry& entry, Bus& bus) const {
    const auto address = entry.unit;
    for (Device& device : std::span(bus.devices).subspan(first_device_)) {
      if (device.address == address) return device;
    }
    Device& device = bus.devices.emplace_back();
    device.address = address;
    device.name = stem_of(source_.file) + (address ? fmt::format("-{}", *address) : "");
    return device;
  }

  MayFail read_cells(ListEntry& entry) {
    const auto address =
        list_address_from(cell(entry, Field::kAddress), {list_.hex, options_.base.value_or(1)});
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
    const std::string_view type_cell = cell(entry, Field::kType);
    const std::string_view area_cell = cell(entry, Field::kArea);
    entry.said = area_by_name(area_cell);
    if (!entry.said && !is_empty_cell(area_cell))
      return fmt::format("table or function '{}' is not understood", area_cell);
    const auto type = list_type_from(type_cell);
    if (!type) return type.error();
    entry.type = *type;
    // One cell of a column of types may name the table.
    if (!entry.said && !type->type && is_area_word(type_cell)) entry.said = area_by_name(type_cell);
    const auto length = length_from(cell(entry, Field::kLength));
    if (!length) return length.error();
    entry.length = *length;
    if (const std::string_view text = cell(entry, Field::kBit); !is_empty_cell(text)) {
      const auto bit = whole_from(text, 0, 15);
      if (!bit) return fmt::format("bit '{}' is not 0 to 15", text);
      entry.address.bit = static_cast<std::uint8_t>(*bit);
    }
    if (auto fault = read_unit(entry)) return fault;
    if (const auto& reference = entry.address.reference;
        reference && !entry.address.plain && entry.said && *entry.said != *reference->area)
      return contradiction(entry);
    return std::nullopt;
  }

  void decide_lengths() {
    if (length_unit_ || !columns_.has(Field::kLength)) return;
    // By types of known width, or else by the distances of consecutive addresses.
    UnitVotes by_type{}, by_step{};
    std::map<std::string, std::map<std::uint32_t, const ListEntry*>> places;
    for (const ListEntry& entry : entries_) {
      if (entry.fault) continue;
      const bool explicit_width = entry.type.type && !entry.type.open;
      // Of a byte, "1" may be its register too.
      if (entry.length && explicit_width && bits_of(*entry.type.type) > 8)
        vote(by_type, *entry.length, bits_of(*entry.type.type));
      const std::string where = fmt::format("{}/{}", entry.unit.value_or(0),
                                            entry.said ? static_cast<int>(*entry.said) : -1);
      const auto& address = entry.address;
      places[where].try_emplace(address.plain ? *address.plain : address.reference->first, &entry);
    }
    for (const auto& [where, entries] : places) {
      for (auto it = entries.begin(); std::next(it) != entries.end(); ++it) {
        const std::uint32_t step = std::next(it)->first - it->first;
        if (it->second->length && step <= 4) vote(by_step, *it->second->length, 16 * step);
      }
    }
    length_unit_ = most(by_type);
    if (!length_unit_) length_unit_ = most(by_step);
  }

  // Number of bits that the row states in addition to its type; empty if it states none.
  std::optional<unsigned> said_bits(ListEntry& entry) const {
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
        entry.point.change("length {} is taken as registers", length.number);
      return length.bits(LengthUnit::kWords);
    }
    if (entry.address.registers > 0) return entry.address.registers * 16;
    return std::nullopt;
  }

  MayFail set_width(ListEntry& entry) {
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
        return fmt::format("no '{}' has {} bits", cell(entry, Field::kType), *bits);
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
      entry.point.change("the type '{}' is taken, which {} bits do not fit",
                         cell(entry, Field::kType), *bits);
    }
    return std::nullopt;
  }

  // A blank cell below a filled one: a spreadsheet had merged them.
  MayFail read_unit(ListEntry& entry) {
    const std::string_view text = cell(entry, Field::kDevice);
    if (is_empty_cell(text)) {
      if (odd_unit_) return "no address of its device, and that of the row above is odd";
      entry.unit = last_unit_;
      if (last_unit_ && !merged_) merged_ = entry.row->line;
      return std::nullopt;
    }
    const auto unit = whole_from(text, 0, 255);
    odd_unit_ = !unit;
    if (odd_unit_) return fmt::format("'{}' is no address of a device", text);
    last_unit_ = entry.unit = static_cast<std::uint16_t>(*unit);
    return std::nullopt;
  }

  // Of a list whose addresses are marked ("0x10", "10h") a bare number may be of either kind.
  void doubt_bare_numbers() {
    const auto is_marked = [](const ListEntry& entry) {
      return !entry.fault && entry.address.marked_hex;
    };
    if (list_.hex || std::ranges::none_of(entries_, is_marked)) return;
    for (ListEntry& entry : entries_) {
      const ListAddress& address = entry.address;
      const bool bare = !address.marked_hex && address.plain && !address.reference;
      if (entry.fault || !bare) continue;
      const std::string_view text = cell(entry, Field::kAddress);
      if (text.size() > 1 && text[0] == '0') {
        entry.fault = fmt::format("address '{}' may be hexadecimal, as others of the list", text);
      } else {
        entry.point.change("address '{}' is read as decimal, others are hexadecimal", text);
      }
    }
  }

  void tell_decisions() {
    if (!list_.hex_note.empty()) tell("{}", list_.hex_note);
    if (merged_)
      tell(
          "rows without an address of their device (line {}, ..) are taken to have that of the row "
          "above",
          *merged_);
    if (list_.gain == ListColumns::Gain::kDivides)
      tell("column 'Gain': raw values are divided by it");
    if (list_.gain == ListColumns::Gain::kMultiplies)
      tell("column 'Gain': raw values are multiplied by it, for it is below 1");
    if (list_.counts_from && base_ != list_.counts_from) {
      tell("the addresses count from {} by --base, not from {} as {}", *base_, *list_.counts_from,
           list_.counts_note);
    } else if (base_ && !options_.base) {
      tell("the addresses count from {}, as {}", *base_, list_.counts_note);
    }
  }

  [[nodiscard]] std::optional<BaseGuess> base_guess() const {
    if (base_) return std::nullopt;
    for (const ListEntry& entry : entries_) {
      const std::string_view text = cell(entry, Field::kAddress);
      if (entry.fault || text.empty()) continue;
      if (entry.address.plain == 0u)
        return BaseGuess{source_.file, 0,
                         fmt::format("the list has an address 0 (line {})", entry.row->line)};
      if (entry.address.reference && is_digit(text[0]) &&
          (counts_from_one_ || !entry.address.plain))
        return BaseGuess{
            source_.file, 1,
            fmt::format("'{}' (line {}) begins with the digit of its table, and such references "
                        "count from 1",
                        text, entry.row->line)};
    }
    return BaseGuess{source_.file, 0,
                     "no title, no digit of a table and no second column says more"};
  }

  [[nodiscard]] std::string contradiction(const ListEntry& entry) const {
    return fmt::format("the address '{}' and '{}' name different tables",
                       cell(entry, Field::kAddress), cell(entry, Field::kArea));
  }

  // "40001" may be the first holding register, or register 40001; the whole list decides.
  void decide_references() {
    counts_from_one_ = references_count_from_one(entries_);
    if (const std::string note = note_of_references(entries_, columns_); !note.empty())
      tell("{}", note);
    for (ListEntry& entry : entries_) {
      if (counts_from_one_ && !entry.fault && entry.address.is_open() && entry.said &&
          *entry.said != *entry.address.reference->area)
        entry.fault = contradiction(entry);
    }
  }

  MayFail place(ListEntry& entry, std::vector<Placed>& placed) {
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
    if (entry.no_type && !holds_bits(*reference.area) && !reference.bit) took_unsigned_ = true;
    if (auto fault =
            read_list_point(list_, table_.rows[header_], options_.word_order, entry, reference))
      return fault;
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

  const SourceText& source_;
  const ReadOptions& options_;
  const Table& table_;
  std::size_t header_;
  const ListColumns list_;
  const Columns& columns_;
  const std::optional<unsigned> base_;  // of the addresses, as the user or the list says it
  std::vector<ListEntry> entries_;
  std::size_t first_device_ = 0;  // of this list; those before are of other lists
  bool counts_from_one_ = false;
  std::optional<std::uint16_t> last_unit_;
  bool odd_unit_ = false;           // of the last row that has one
  std::optional<unsigned> merged_;  // the first line that has the unit of the row above
  bool took_holding_ = false;
  bool took_unsigned_ = false;
  std::optional<LengthUnit> length_unit_;  // of the numbers in the column of lengths
  std::vector<std::string> notes_;
};

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
    if (!table) return refused("{}: {}", source.file, table.error());
    const auto header = header_row(*table);
    if (!header)
      return refused(
          "{}: none of its first {} rows names the columns: an address (Address, Register) and two "
          "more (Name, Type, Unit, Scale, Function, ..) are needed",
          source.file, kTitleRows);
    ListReader(source, options, *table, *header).read(bus, found);
  }
  return found;
}

}  // namespace

constinit const Format kModbusListFormat{"modbus-list", "list of Modbus registers (CSV, Excel)",
                                         recognise_modbus_list, read_modbus_list};

}  // namespace fieldcast::importing

#include "tools/import/formats/list/list_columns.hpp"

#include <cmath>

namespace fieldcast::importing {
namespace {

constexpr Words<Field> kListColumns[] = {
    {"name tagname tag signal signalname parameter parametername variable variablename "
     "registername measurement quantity point pointname label item symbol bezeichnung "
     "messwert nom nombre nome designation variableengunit",
     Field::kName},
    {"address adress addr adresse modbusaddress modbusadresse register registeraddress "
     "addressregister registernumber registerno regaddr reg registre registro startaddress "
     "startregister modbusregister modbusreg dataaddress addressdec protocoladdress "
     "plcaddress physicaladdress modiconaddress modicomaddress parameterregister pduaddress "
     "start startaddr startreg startadresse startingaddress registeradresse registernummer "
     "registeraddr regaddress regadresse modbusregisteraddress addressdecimal decaddress "
     "addresshex hexaddress direccion indirizzo",
     Field::kAddress},
    {"function functioncode fc modbusfunction modbusfunctioncode functioncoderead "
     "readfunction readfc funktion funktionscode registertype regtype area table objecttype "
     "datatable registertable registertyp tabelle kind",
     Field::kArea},
    {"type datatype dataformat format datentyp datenformat typ valuetype encoding tipo "
     "typededonnees",
     Field::kType},
    {"access rw readwrite readandwrite accesstype accessmode zugriff zugriffsart "
     "lesenschreiben permission attribute mode",
     Field::kAccess},
    {"scale scaling factor scalefactor scalingfactor multiplier faktor skalierung "
     "resolution res coefficient auflosung aufloesung multiplikator mult",
     Field::kScale},
    {"gain divisor divider teiler", Field::kDivisor},
    {"decimals decimalplaces nachkommastellen kommastellen", Field::kDecimals},
    {"offset valueoffset bias", Field::kOffset},
    {"unit units einheit engunit engunits engineeringunits uom unite unita unidad", Field::kUnit},
    {"description details beschreibung comment kommentar remark bemerkung remarks notes "
     "note",
     Field::kDescription},
    {"bit bitposition bitnumber", Field::kBit},
    {"length size count registers numberofregisters noofregisters numregisters "
     "quantityofregisters words anzahl lange laenge bytes bits",
     Field::kLength},
    {"wordorder byteorder endian wortreihenfolge bytereihenfolge endianness order",
     Field::kWordOrder},
    {"slave slaveid slaveaddress unitid deviceid deviceaddress slaveadresse geraeteadresse",
     Field::kDevice},
    {"refresh pollinterval interval scanrate pollms refreshms", Field::kRefresh}};

// Letters of other languages, spelled as in the words above.
constexpr Replacement kPlainLetters[] = {{"ä", "ae"}, {"ö", "oe"}, {"ü", "ue"}, {"Ä", "ae"},
                                         {"Ö", "oe"}, {"Ü", "ue"}, {"ß", "ss"}, {"é", "e"},
                                         {"è", "e"},  {"ó", "o"},  {"ñ", "n"},  {"à", "a"},
                                         {"á", "a"},  {"í", "i"},  {"ç", "c"}};

constexpr std::string_view kRemarks =
    "dec decimal dez dezimal hex hexadecimal hexadezimal 1based 0based onebased zerobased base1 "
    "base0 words bytes registers bits ms";

std::string list_title_word(std::string_view title) {
  const std::string word = column_word(with_replaced(lower(title), kPlainLetters));
  const auto is_known = [](std::string_view name) {
    return value_of(kListColumns, name).has_value();
  };
  if (is_known(word)) return word;
  // "Reg. Addr (dec)", "Adresse hex", "Register (1-based)", "Length (words)"
  for (const std::string_view end : split(kRemarks, ' ')) {
    const std::string begin = word.substr(0, word.size() - std::min(end.size(), word.size()));
    if (word.ends_with(end) && is_known(begin)) return begin;
  }
  return word;
}

std::optional<unsigned> first_address_of_title(std::string_view word) {
  const auto has = [&](std::string_view part) { return contains(word, part); };
  if (has("1based") || has("onebased") || has("base1")) return 1;
  if (has("0based") || has("zerobased") || has("base0") || has("protocol") || has("pdu")) return 0;
  return std::nullopt;
}

std::optional<LengthUnit> length_unit_of_title(std::string_view word) {
  if (contains(word, "byte")) return LengthUnit::kBytes;
  if (contains(word, "bits")) return LengthUnit::kBits;
  if (contains(word, "word") || contains(word, "reg")) return LengthUnit::kWords;
  return std::nullopt;
}

bool names_areas(std::span<const Row> rows, std::size_t column) {
  bool any = false;
  for (const Row& row : rows) {
    const auto cell = row.cell(column);
    if (cell.empty()) continue;
    if (!is_area_word(cell)) return false;
    any = true;
  }
  return any;
}

// "12", "000C"; "1e3" is a number with an exponent.
bool is_hex_or_decimal(std::string_view cell) {
  if (cell.empty() || !is_digit(cell[0]) ||
      cell.find_first_not_of("0123456789abcdef") != std::string_view::npos)
    return false;
  const std::size_t letter = cell.find_first_of("abcdef");
  const bool exponent = letter != std::string_view::npos && cell[letter] == 'e' &&
                        cell.find_first_of("abcdef", letter + 1) == std::string_view::npos;
  return !exponent || letter + 1 == cell.size() || cell[0] == '0';
}

}  // namespace

Columns list_columns(const Row& header) {
  Columns columns(header, kListColumns, list_title_word);
  const auto offset = columns.index_of(Field::kOffset);
  if (offset && !columns.has(Field::kAddress) &&
      list_title_word(header.cell(*offset)) == "offset") {
    columns.set(Field::kAddress, offset);
    columns.set(Field::kOffset, std::nullopt);
  }
  return columns;
}

ListColumns::ListColumns(const Table& table, std::size_t header)
    : columns(list_columns(table.rows[header])) {
  const Row& titles = table.rows[header];
  const Rows rows = std::span(table.rows).subspan(header + 1);
  if (const auto address = columns.index_of(Field::kAddress)) {
    const std::string word = column_word(titles.cell(*address));
    hex = contains(word, "hex");
    counts_from = first_address_of_title(word);
    if (counts_from) counts_note = "their title says";
  }
  find_areas(rows);
  release_function(titles, rows);
  for (const Row& row : rows) {
    for (const Field field : {Field::kScale, Field::kDivisor})
      style.learn(columns.cell(row, field));
  }
  find_hex(rows);
  if (!counts_from) compare_addresses(titles, rows);
  decide_gain(titles, rows);
  if (const auto length = columns.index_of(Field::kLength))
    length_unit = length_unit_of_title(column_word(titles.cell(*length)));
}

// A type column in which every cell names a table contains the areas; then a second column has the
// types.
void ListColumns::find_areas(Rows rows) {
  std::vector<std::size_t> candidates = columns.others(Field::kType);
  if (const auto first = columns.index_of(Field::kType))
    candidates.insert(candidates.begin(), *first);
  std::optional<std::size_t> types;
  for (const std::size_t column : candidates) {
    if (!names_areas(rows, column)) {
      if (!types) types = column;
    } else if (!columns.has(Field::kArea)) {
      columns.set(Field::kArea, column);
    }
  }
  columns.set(Field::kType, types);
}

// A column "Function" may describe the purpose of a value instead.
void ListColumns::release_function(const Row& titles, Rows rows) {
  const auto column = columns.index_of(Field::kArea);
  if (!column || !is_one_of(column_word(titles.cell(*column)), "function funktion kind")) return;
  for (const Row& row : rows) {
    const auto cell = row.cell(*column);
    if (area_by_name(cell) || cell.find_first_of("0123456789") != std::string_view::npos) return;
  }
  columns.set(Field::kArea, std::nullopt);
}

// "0012" and "000C": all are hexadecimal if they have equal lengths and one has a leading zero.
void ListColumns::find_hex(Rows rows) {
  const Row* letters = nullptr;
  bool zeros = false, same = true;
  std::size_t size = 0;
  for (const Row& row : rows) {
    const std::string cell = lower(columns.cell(row, Field::kAddress));
    if (!is_hex_or_decimal(cell)) continue;
    if (!letters && !all_digits(cell)) letters = &row;
    same = same && (size == 0 || size == cell.size());
    size = cell.size();
    zeros = zeros || (cell[0] == '0' && cell.size() > 2);
  }
  if (!letters || hex) return;
  hex = same && zeros;
  const std::string_view cell = columns.cell(*letters, Field::kAddress);
  hex_note =
      hex ? fmt::format("all addresses are hexadecimal, as '{}' (line {}) is", cell, letters->line)
          : fmt::format(
                "the address '{}' (line {}) may be hexadecimal; the others are read as decimal",
                cell, letters->line);
}

// "Gain" has two meanings: 10 divides the raw value, 0.1 multiplies it. A divisor below one is not
// used; a column with both is unclear.
void ListColumns::decide_gain(const Row& titles, Rows rows) {
  const auto column = columns.index_of(Field::kDivisor);
  if (!column || column_word(titles.cell(*column)) != "gain") return;
  bool more = false, less = false;
  for (const Row& row : rows) {
    const auto factor = factor_from(row.cell(*column), style);
    if (!factor || !*factor) continue;
    more = more || std::abs((*factor)->value) > 1;
    less = less || std::abs((*factor)->value) < 1;
  }
  gain = more && less ? Gain::kUnclear : less ? Gain::kMultiplies : Gain::kDivides;
}

// "40001 | 0000", "5001 | 5000": one of two address columns has the protocol's addresses.
void ListColumns::compare_addresses(const Row& titles, Rows rows) {
  // 300001 can only be a reference.
  const auto is_behind = [](const ListAddress& counted, std::optional<std::uint32_t> number) {
    return number && (counted.plain == *number + 1 ||
                      (counted.reference && counted.reference->first == *number));
  };
  for (const std::size_t column : columns.others(Field::kAddress)) {
    const std::string_view title = titles.cell(column);
    const bool second_hex = contains(column_word(title), "hex");
    bool from_one = true, from_zero = true, any = false;
    for (const Row& row : rows) {
      const auto listed = list_address_from(columns.cell(row, Field::kAddress), {hex});
      const auto second = list_address_from(row.cell(column), {second_hex});
      if (!listed || !second) continue;
      any = any || listed->plain || second->plain;
      from_one = from_one && is_behind(*listed, second->plain);
      from_zero = from_zero && is_behind(*second, listed->plain);
    }
    if (!any || from_one == from_zero) continue;
    counts_from = from_one ? 1 : 0;
    counts_note = fmt::format("the column '{}' beside them shows", title);
    return;
  }
}

}  // namespace fieldcast::importing

#include "tools/import/formats/list/list_type.hpp"

#include <algorithm>

#include "tools/import/points/address.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

// Bytes in wire order, counted from 1 or 0, as letters.
constexpr Words<std::string_view> kDigits[] = {{"1234 0123", "abcd"},
                                               {"3412 2301", "cdab"},
                                               {"2143 1032 bigendianbyteswap", "badc"},
                                               {"4321 3210", "dcba"}};
constexpr Words<ListOrder> kOrders[] = {
    {"none na", {}},
    {"big bigendian be", {WordOrder::kBigEndian, {}}},
    {"little littleendian le", {WordOrder::kLittleEndian, {}, true}}};
// Ambiguous if the title is about bytes.
constexpr Words<ListOrder> kWordOrders[] = {
    {"highfirst highwordfirst highword high highlow hilo hl hwf mswfirst mswf msw msbfirst msb "
     "mostsignificantwordfirst normal standard notswapped motorola",
     {WordOrder::kBigEndian, {}}},
    {"lowfirst lowwordfirst lowword low lowhigh lohi lh lwf lswfirst lswf lsw lsbfirst lsb "
     "leastsignificantwordfirst wordswap wordswapped wordsswapped swapwords swappedwords swapped "
     "swap inverse inverted",
     {WordOrder::kLittleEndian, {}}}};
// "R/WC" is written by a device command, not by a register write.
constexpr Words<Access> kAccess[] = {
    {"r ro read readonly rwc lesen l nurlesen", Access::kReadOnly},
    {"rw wr readwrite writeread readandwrite lesenschreiben schreibenlesen lesenundschreiben ls",
     Access::kReadWrite},
    {"w wo write writeonly schreiben s", Access::kWriteOnly}};
constexpr Words<LengthUnit> kUnits[] = {
    {"word words w register registers reg regs wort worte worter", LengthUnit::kWords},
    {"byte bytes b char chars octets", LengthUnit::kBytes},
    {"bit bits", LengthUnit::kBits}};

constexpr std::uint64_t kLongest = 10'000;  // a greater number is not a length

bool is_blank(std::string_view cell) {
  return cell.empty() || cell == "-" || cell == "--" || cell == "\u2013";
}

// Names without a width; a digit in the name determines it.
bool leaves_width_open(std::string_view cell) {
  std::string word = column_word(cell);
  if (const std::size_t at = word.find("754"); at != std::string::npos) word.erase(at, 3);
  if (word.find_first_of("0123456789") != std::string::npos) return false;
  for (const std::string_view wide : {"long", "short", "double"})
    if (contains(word, wide)) return false;
  for (const std::string_view begin : {"int", "uint", "signed", "unsigned", "enum", "bitmap",
                                       "register", "bcd", "float", "real", "ieee"})
    if (word.starts_with(begin)) return true;
  return false;
}

}  // namespace

Result<ListOrder> list_order_from(std::string_view cell, bool of_bytes) {
  const std::string word = column_word(cell);
  if (word.empty()) return ListOrder{};
  if (const auto orders = orders_by_letters(value_of(kDigits, word).value_or(word)))
    return ListOrder{orders->words, orders->bytes};
  if (const auto order = value_of(kOrders, word)) return *order;
  if (const auto order = of_bytes ? std::nullopt : value_of(kWordOrders, word)) return *order;
  return refused("order '{}' is not understood; say it as ABCD, CDAB, ..", cell);
}

std::optional<Access> access_from(std::string_view cell) {
  const std::string word = column_word(cell);
  return word.empty() ? Access::kReadOnly : value_of(kAccess, word);
}

unsigned Length::bits(LengthUnit as) const {
  return number * (as == LengthUnit::kWords ? 16 : as == LengthUnit::kBytes ? 8 : 1);
}

Result<std::optional<Length>> length_from(std::string_view cell) {
  cell = trimmed(cell);
  if (is_blank(cell)) return std::nullopt;
  const std::size_t end = std::min(cell.find_first_not_of("0123456789"), cell.size());
  const auto number = whole_from(cell.substr(0, end), 0, kLongest);
  const std::string_view rest = trimmed(cell.substr(end));
  // "2.0": a spreadsheet added decimals.
  const bool decimals = rest.size() > 1 && (rest[0] == '.' || rest[0] == ',') &&
                        rest.find_first_not_of('0', 1) == std::string_view::npos;
  const auto unit = value_of(kUnits, column_word(rest));
  if (!number || (!rest.empty() && !decimals && !unit))
    return refused("length '{}' is not understood", cell);
  if (*number == 0) return std::nullopt;
  return Length{static_cast<unsigned>(*number), unit};
}

Result<ListType> list_type_from(std::string_view cell) {
  cell = trimmed(cell);
  ListType found;
  if (is_blank(cell)) return found;
  found.type = type_by_name(cell);
  found.open = found.type && leaves_width_open(cell);
  if (found.type || is_area_word(cell)) return found;
  const auto length = length_from(cell);
  if (!length || !*length || !(*length)->unit) return refused("data type '{}' is unknown", cell);
  found.bits = (*length)->bits(*(*length)->unit);
  return found;
}

unsigned bits_of(const TypeName& type) {
  if (type.type == ValueType::kBool) return 0;
  if (type.type == ValueType::kString) return type.string_bytes * 8u;
  return is_byte(type.type) || type.type == ValueType::kBcd8 ? 8 : registers_of(type.type, 0) * 16;
}

std::optional<ValueType> as_wide(ValueType type, unsigned bits) {
  constexpr std::pair<unsigned, ValueType> kBcd[] = {
      {8, ValueType::kBcd8}, {16, ValueType::kBcd16}, {32, ValueType::kBcd32}};
  constexpr std::pair<unsigned, ValueType> kFloat[] = {{32, ValueType::kFloat32},
                                                       {64, ValueType::kFloat64}};
  const auto of_width = [bits](const auto& types) -> std::optional<ValueType> {
    for (const auto& [width, wide] : types) {
      if (width == bits) return wide;
    }
    return std::nullopt;
  };
  switch (type) {
    case ValueType::kInt16: return integer_of(bits, true);
    case ValueType::kUint16: return integer_of(bits, false);
    case ValueType::kFloat32: return of_width(kFloat);
    case ValueType::kBcd16: return of_width(kBcd);
    default: return std::nullopt;
  }
}

}  // namespace fieldcast::importing

#include "tools/import/formats/list/list_type.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

namespace {

// Bytes in wire order, counted from 1 or 0, as letters.
struct OrderDigits {
  std::string_view word, letters;
};
constexpr OrderDigits kDigits[] = {
    {"1234", "abcd"}, {"3412", "cdab"}, {"2143", "badc"},
    {"4321", "dcba"}, {"0123", "abcd"}, {"2301", "cdab"},
    {"1032", "badc"}, {"3210", "dcba"}, {"bigendianbyteswap", "badc"}};

constexpr std::string_view kHighFirst[] = {"highfirst",  "highwordfirst",
                                           "highword",   "high",
                                           "highlow",    "hilo",
                                           "hl",         "hwf",
                                           "mswfirst",   "mswf",
                                           "msw",        "msbfirst",
                                           "msb",        "mostsignificantwordfirst",
                                           "normal",     "standard",
                                           "notswapped", "motorola"};
constexpr std::string_view kLowFirst[] = {"lowfirst",     "lowwordfirst",
                                          "lowword",      "low",
                                          "lowhigh",      "lohi",
                                          "lh",           "lwf",
                                          "lswfirst",     "lswf",
                                          "lsw",          "lsbfirst",
                                          "lsb",          "leastsignificantwordfirst",
                                          "wordswap",     "wordswapped",
                                          "wordsswapped", "swapwords",
                                          "swappedwords", "swapped",
                                          "swap",         "inverse",
                                          "inverted"};

}  // namespace

tl::expected<ListOrder, std::string> list_order_from(std::string_view cell, bool of_bytes) {
  const std::string word = column_word(cell);
  if (word.empty() || word == "none" || word == "na") return ListOrder{};
  const auto digits = std::ranges::find(kDigits, word, &OrderDigits::word);
  if (const auto orders = orders_by_letters(digits == std::end(kDigits) ? word : digits->letters))
    return ListOrder{orders->words, orders->bytes};
  for (const std::string_view big : {"big", "bigendian", "be"})
    if (word == big) return ListOrder{WordOrder::kBigEndian, std::nullopt};
  for (const std::string_view little : {"little", "littleendian", "le"})
    if (word == little) return ListOrder{WordOrder::kLittleEndian, std::nullopt, true};
  if (!of_bytes) {
    if (std::ranges::find(kHighFirst, word) != std::end(kHighFirst))
      return ListOrder{WordOrder::kBigEndian, std::nullopt};
    if (std::ranges::find(kLowFirst, word) != std::end(kLowFirst))
      return ListOrder{WordOrder::kLittleEndian, std::nullopt};
  }
  return tl::unexpected(
      fmt::format("order '{}' is not understood; say it as ABCD, CDAB, ..", cell));
}

std::optional<Access> access_from(std::string_view cell) {
  const std::string word = column_word(cell);
  // "R/WC" is written by a device command, not by a register write.
  for (const std::string_view read :
       {"", "r", "ro", "read", "readonly", "rwc", "lesen", "l", "nurlesen"})
    if (word == read) return Access::kReadOnly;
  for (const std::string_view both :
       {"rw", "wr", "readwrite", "writeread", "readandwrite", "lesenschreiben", "schreibenlesen",
        "lesenundschreiben", "ls"})
    if (word == both) return Access::kReadWrite;
  for (const std::string_view write : {"w", "wo", "write", "writeonly", "schreiben", "s"})
    if (word == write) return Access::kWriteOnly;
  return std::nullopt;
}

namespace {

constexpr std::uint64_t kLongest = 10'000;  // a greater number is not a length

bool is_blank(std::string_view cell) {
  return cell.empty() || cell == "-" || cell == "--" || cell == "\u2013";
}

std::optional<LengthUnit> unit_from(std::string_view word) {
  for (const std::string_view name :
       {"word", "words", "w", "register", "registers", "reg", "regs", "wort", "worte", "worter"})
    if (word == name) return LengthUnit::kWords;
  for (const std::string_view name : {"byte", "bytes", "b", "char", "chars", "octets"})
    if (word == name) return LengthUnit::kBytes;
  for (const std::string_view name : {"bit", "bits"})
    if (word == name) return LengthUnit::kBits;
  return std::nullopt;
}

// Names without a width; a digit in the name determines it.
bool leaves_width_open(std::string_view cell) {
  std::string word = column_word(cell);
  if (const std::size_t at = word.find("754"); at != std::string::npos) word.erase(at, 3);
  if (word.find_first_of("0123456789") != std::string::npos) return false;
  for (const std::string_view wide : {"long", "short", "double"})
    if (word.find(wide) != std::string::npos) return false;
  for (const std::string_view begin : {"int", "uint", "signed", "unsigned", "enum", "bitmap",
                                       "register", "bcd", "float", "real", "ieee"})
    if (word.starts_with(begin)) return true;
  return false;
}

}  // namespace

unsigned Length::bits(LengthUnit as) const {
  switch (as) {
    case LengthUnit::kWords: return number * 16;
    case LengthUnit::kBytes: return number * 8;
    case LengthUnit::kBits: return number;
  }
  return 0;
}

tl::expected<std::optional<Length>, std::string> length_from(std::string_view cell) {
  cell = trimmed(cell);
  if (is_blank(cell)) return std::nullopt;
  const std::size_t end = std::min(cell.find_first_not_of("0123456789"), cell.size());
  // "2.0": a spreadsheet added decimals.
  const auto number = whole_from(cell.substr(0, end));
  const std::string_view rest = trimmed(cell.substr(end));
  const bool decimals = !rest.empty() && (rest[0] == '.' || rest[0] == ',') && rest.size() > 1 &&
                        rest.find_first_not_of('0', 1) == std::string_view::npos;
  const auto unit = unit_from(column_word(rest));
  if (!number || *number > kLongest || (!rest.empty() && !decimals && !unit))
    return tl::unexpected(fmt::format("length '{}' is not understood", cell));
  if (*number == 0) return std::nullopt;
  return Length{static_cast<unsigned>(*number), unit};
}

tl::expected<ListType, std::string> list_type_from(std::string_view cell) {
  cell = trimmed(cell);
  ListType found;
  if (is_blank(cell)) return found;
  if (const auto type = type_by_name(cell)) {
    found.type = type;
    found.open = leaves_width_open(cell);
    return found;
  }
  if (is_area_word(cell)) return found;
  if (const auto length = length_from(cell); length && *length && (*length)->unit) {
    found.bits = (*length)->bits(*(*length)->unit);
    return found;
  }
  return tl::unexpected(fmt::format("data type '{}' is unknown", cell));
}

unsigned bits_of(const TypeName& type) {
  if (type.type == ValueType::kBool) return 0;
  if (type.type == ValueType::kString) return type.string_bytes * 8u;
  if (type.type == ValueType::kInt8 || type.type == ValueType::kUint8 ||
      type.type == ValueType::kBcd8)
    return 8;
  return registers_of(type.type, 0) * 16;
}

std::optional<ValueType> as_wide(ValueType type, unsigned bits) {
  switch (type) {
    case ValueType::kInt16: return integer_of(bits, true);
    case ValueType::kUint16: return integer_of(bits, false);
    case ValueType::kFloat32:
      if (bits == 64) return ValueType::kFloat64;
      return bits == 32 ? std::optional(type) : std::nullopt;
    case ValueType::kBcd16:
      if (bits == 8) return ValueType::kBcd8;
      if (bits == 32) return ValueType::kBcd32;
      return bits == 16 ? std::optional(type) : std::nullopt;
    default: return std::nullopt;
  }
}

}  // namespace fieldcast::importing

#include "tools/import/formats/list/list_cells.hpp"

#include <algorithm>
#include <cmath>

#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMostRegisters = 125;  // of one value
constexpr double kLargestExponent = 18;

using Parsed = Result<ListAddress>;
using Notation = AddressNotation;

// Typographic dashes, blanks and dots; the words of a range become two dots.
constexpr Replacement kPlainSigns[] = {
    {"\u2010", "-"}, {"\u2011", "-"}, {"\u2012", "-"}, {"\u2013", "-"}, {"\u2014", "-"},
    {"\u2212", "-"}, {"\u00A0", " "}, {"\u202F", " "}, {"\u2009", " "}, {"\u2026", ".."},
    {" to ", ".."},  {" TO ", ".."},  {" bis ", ".."}};

// "1,234", "1.000", "40 101", "1'234": groups of three digits after one to three.
bool has_thousands(std::string_view text) {
  const std::size_t first = std::ranges::find_if_not(text, is_digit) - text.begin();
  if (first == 0 || first > 3 || first == text.size()) return false;
  for (std::size_t at = first; at < text.size(); at += 4) {
    if (!contains(",.' ", text.substr(at, 1))) return false;
    if (text.size() - at < 4 || !all_digits(text.substr(at + 1, 3))) return false;
    if (text.size() - at > 4 && is_digit(text[at + 4])) return false;
  }
  return true;
}

Parsed single(std::string_view text, Notation notation) {
  text = trimmed(text);
  ListAddress address;
  const bool marked = text.starts_with("0x") || text.starts_with("0X") || text.starts_with('$') ||
                      (lower(text).ends_with('h') && text.size() > 1 && is_digit(text[0]));
  if (notation.hex && !marked) {
    const auto number = whole_from(fmt::format("0x{}", text), 0, 0xFFFF);
    if (!number) return refused("'{}' is no hexadecimal address from 0 to FFFF", text);
    address.plain = static_cast<std::uint32_t>(*number);
    return address;
  }
  // A blank is allowed only between letters and a number: "HR 100", not "4 0010".
  for (std::size_t at = text.find(' '); at != std::string_view::npos; at = text.find(' ', at + 1)) {
    if (is_digit(text[at - 1])) return refused("'{}' is not an address: it contains a blank", text);
  }
  const auto reference = reference_from(text, notation.base);
  const std::string_view digits = halves(text, '.').first;
  if (const auto number = whole_from(digits, 0, 65535))
    address.plain = static_cast<std::uint32_t>(*number);
  if (!reference && !(address.plain && digits == text)) return tl::unexpected(reference.error());
  address.marked_hex = marked;
  if (reference) {
    address.bit = reference->bit;
    if (reference->area) address.reference = *reference;
  }
  return address;
}

std::optional<std::int64_t> steps(const ListAddress& first, const ListAddress& second) {
  if (first.plain && second.plain) return std::int64_t{*second.plain} - *first.plain;
  if (!first.reference || !second.reference) return std::nullopt;
  if (first.reference->area != second.reference->area) return std::nullopt;
  return std::int64_t{second.reference->first} - first.reference->first;
}

// "30001/2": the second part has only the last digits.
std::string whole_number(std::string_view first, std::string_view second) {
  if (all_digits(first) && all_digits(second) && second.size() < first.size() && second[0] != '0')
    return fmt::format("{}{}", first.substr(0, first.size() - second.size()), second);
  return std::string(second);
}

Parsed several(std::string_view cell, const std::vector<std::string_view>& parts, bool is_range,
               Notation notation) {
  if (std::ranges::any_of(parts, [](std::string_view part) { return trimmed(part).empty(); }))
    return refused("the range '{}' is open; name its first and its last register: 40003..40004",
                   cell);
  auto first = single(parts.front(), notation);
  if (!first) return refused("'{}' is no address", cell);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const bool whole = notation.hex || is_range;
    const auto next =
        single(whole ? std::string(parts[i]) : whole_number(parts[0], parts[i]), notation);
    const auto far = next ? steps(*first, *next) : std::nullopt;
    const bool right = far && (is_range ? *far >= 0 && *far < kMostRegisters
                                        : *far == static_cast<std::int64_t>(i));
    if (!right || first->bit || next->bit)
      return refused("'{}' is no address, and no registers one behind the other", cell);
    first->registers = static_cast<unsigned>(*far) + 1;
  }
  return first;
}

Parsed without_remark(std::string_view text, Notation notation) {
  if (has_thousands(text))
    return refused("'{}' is no address: is it one number with separators, or two?", text);
  if (const std::size_t dots = text.find(".."); dots != std::string_view::npos && dots > 0) {
    const std::size_t last = std::min(text.find_first_not_of('.', dots), text.size());
    return several(text, {text.substr(0, dots), text.substr(last)}, true, notation);
  }
  // "40001,0" of a spreadsheet with decimal commas.
  if (const auto [whole, decimals] = halves(text, ',');
      !decimals.empty() && decimals.find_first_not_of('0') == std::string_view::npos)
    return single(whole, notation);
  // "3-0007" is a reference, "3-4" are two registers.
  const bool is_reference =
      text.size() >= 6 && text[1] == '-' && all_digits(text.substr(2)) && area_of_digit(text[0]);
  for (const char separator : {'-', '~'}) {
    const std::size_t at = text.find(separator, 1);
    if (at != std::string_view::npos && !is_reference)
      return several(text, {text.substr(0, at), text.substr(at + 1)}, true, notation);
  }
  for (const char separator : {',', ';', '/', '+'}) {
    if (text.find(separator) != std::string_view::npos)
      return several(text, split(text, separator), false, notation);
  }
  return single(text, notation);
}

// "100 (0x64)", "40001 (0)": the second number must be equal, or counted from 0.
Parsed with_remark(std::string_view cell, std::string_view text, std::string_view remark,
                   Notation notation) {
  auto address = without_remark(trimmed(text), notation);
  if (!address) return address;
  const auto number = whole_from(remark);
  if (number && address->plain && *number == *address->plain) return address;
  if (!number || !address->reference || *number != address->reference->first)
    return refused("'{}' is no address that is understood", cell);
  address->plain.reset();
  return address;
}

}  // namespace

Parsed list_address_from(std::string_view cell, Notation notation) {
  const std::string whole = with_replaced(cell, kPlainSigns);
  std::string_view text = trimmed(whole);
  if (text.empty()) return refused("no address");
  std::optional<std::uint64_t> bit;
  if (const std::size_t at = lower(text).find("bit"); at != std::string_view::npos && at > 0) {
    bit = whole_from(text.substr(at + 3), 0, 15);
    if (!bit) return refused("bit '{}' is not 0 to 15", trimmed(text.substr(at + 3)));
    text = trimmed(text.substr(0, at));
  }
  const std::size_t bracket = text.find('(');
  auto address = bracket != std::string_view::npos && bracket > 0 && text.ends_with(')')
                     ? with_remark(cell, text.substr(0, bracket),
                                   text.substr(bracket + 1, text.size() - bracket - 2), notation)
                     : without_remark(text, notation);
  if (!address || !bit) return address;
  if (address->bit || address->registers > 1) return refused("'{}' is no address of a bit", cell);
  address->bit = static_cast<std::uint8_t>(*bit);
  return address;
}

namespace {

constexpr Replacement kFactorSigns[] = {{"**", "^"},     {"\u00D7", "*"}, {"\u00B7", "*"},
                                        {"\u22C5", "*"}, {"\u00F7", "/"}, {"\u2212", "-"},
                                        {"\u2013", "-"}, {"\u00A0", " "}};
constexpr Replacement kRaised[] = {{"\u2070", "0"}, {"\u00B9", "1"}, {"\u00B2", "2"},
                                   {"\u00B3", "3"}, {"\u2074", "4"}, {"\u2075", "5"},
                                   {"\u2076", "6"}, {"\u2077", "7"}, {"\u2078", "8"},
                                   {"\u2079", "9"}, {"\u207B", "-"}, {"\u207A", ""}};

// Replaces typographic signs by ASCII; raised digits after a digit become "^-3".
std::string factor_signs(std::string_view cell) {
  const std::string plain = with_replaced(cell, kFactorSigns);
  std::string text;
  bool raised = false;
  for (std::string_view rest = plain; !rest.empty();) {
    const auto up = std::ranges::find_if(
        kRaised, [&](const Replacement& sign) { return rest.starts_with(sign.first); });
    const bool behind_digit = raised || (!text.empty() && is_digit(text.back()));
    const bool raises = up != std::end(kRaised) && behind_digit;
    if (raises && !raised) text += '^';
    raised = raises;
    text += raises ? up->second : rest.substr(0, 1);
    rest.remove_prefix(raises ? up->first.size() : 1);
  }
  return std::string(trimmed(text));
}

// "1,000" may be one or a thousand, and so may "1.000" with decimal commas.
bool has_two_meanings(std::string_view text, NumberStyle style) {
  const std::size_t at = text.find_first_of(",.");
  const std::size_t first = text.find_first_not_of("+-");
  if (at == std::string_view::npos || first == std::string_view::npos || at <= first) return false;
  const bool thousands = text[first] != '0' && at - first <= 3 && text.size() - at == 4;
  if (!thousands) return false;
  return text[at] == ',' ? !style.decimal_comma || style.decimal_point : style.decimal_comma;
}

// The error is empty for a text that is not a number.
using Number = Result<double>;
tl::unexpected<std::string> no_number() { return tl::unexpected(std::string()); }

Number plain_number(std::string_view text, NumberStyle style) {
  text = trimmed(text);
  const auto number = number_from(text);
  if (!number) return no_number();
  if (has_two_meanings(text, style))
    return refused("'{}' may be {} or {} thousand", text, *number, *number);
  return *number;
}

Number power(std::string_view text, NumberStyle style) {
  const auto [base_text, behind] = halves(text, '^');
  if (base_text.size() == text.size()) return plain_number(text, style);
  std::string_view raised = trimmed(behind);
  if (raised.starts_with('(') && raised.ends_with(')'))
    raised = raised.substr(1, raised.size() - 2);
  const auto base = plain_number(base_text, style);
  const auto exponent = plain_number(raised, style);
  if (!base || !exponent || *exponent != std::floor(*exponent) ||
      std::abs(*exponent) > kLargestExponent)
    return no_number();
  // Exactly 0.001, not a product of tenths.
  if (*base == 10) return number_from(fmt::format("1e{}", static_cast<int>(*exponent))).value_or(0);
  return std::pow(*base, *exponent);
}

Number terms(std::string_view text, NumberStyle style) {
  double value = 1;
  char sign = '*';
  text = trimmed(text);
  if (!text.empty() && contains("xX*/:", text.substr(0, 1))) {
    sign = text[0];
    text = trimmed(text.substr(1));
  }
  for (;;) {
    const std::size_t end =
        text.starts_with("0x") ? text.find_first_of("*/:", 2) : text.find_first_of("xX*/:");
    const auto term = power(text.substr(0, end), style);
    if (!term) return term;
    const bool divide = sign == '/' || sign == ':';
    if (divide && *term == 0) return no_number();
    value = divide ? value / *term : value * *term;
    if (end == std::string_view::npos) return value;
    sign = text[end];
    text.remove_prefix(end + 1);
  }
}

// Start of the unit after a number: "0.1 kWh", "0,01 m³/h".
std::size_t unit_begin(std::string_view text) {
  for (std::size_t i = 1; i < text.size(); ++i) {
    const char c = text[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' ||
                        static_cast<unsigned char>(c) >= 0x80;
    const bool exponent = (c == 'e' || c == 'E') && i + 1 < text.size() &&
                          (is_digit(text[i + 1]) || text[i + 1] == '-' || text[i + 1] == '+');
    const bool sign =
        (c == 'x' || c == 'X') && (i < 2 || text[i - 1] == ' ' || is_digit(text[i - 1]));
    if (letter && !exponent && !sign) return i;
  }
  return std::string_view::npos;
}

bool is_unit(std::string_view text) {
  return !text.empty() && text.size() <= 12 && text != "n" &&
         text.find_first_of("0123456789,;=*^+. ") == std::string_view::npos;
}

std::string_view without_step(std::string_view unit) {
  for (const std::string_view step : {"/bit", "/Bit", "/digit", "/Digit", "/LSB", "/lsb"})
    if (unit.ends_with(step)) return unit.substr(0, unit.size() - step.size());
  return unit;
}

}  // namespace

void NumberStyle::learn(std::string_view cell) {
  const std::size_t at = cell.find_first_of(",.");
  if (at == std::string_view::npos || cell.find_first_of(",.", at + 1) != std::string_view::npos)
    return;
  const std::size_t end = std::min(cell.find_first_not_of("0123456789", at + 1), cell.size());
  const std::size_t begin = cell.find_last_not_of("0123456789", at - (at > 0 ? 1 : 0)) + 1;
  const std::size_t digits = end - at - 1;
  const bool certain = digits > 0 && (digits != 3 || at <= begin || cell[begin] == '0');
  if (certain) (cell[at] == ',' ? decimal_comma : decimal_point) = true;
}

Result<std::optional<Factor>> factor_from(std::string_view cell, NumberStyle style) {
  const std::string whole = factor_signs(cell);
  std::string_view text = whole;
  if (text.empty() || is_one_of(lower(text), "- -- none n/a na no keine")) return std::nullopt;
  // "1 = 0.1": one step of the raw value.
  if (const auto [step, value] = halves(text, '='); step.size() < text.size()) {
    if (number_from(step) != 1.0) return refused("'{}' is not understood", cell);
    text = trimmed(value);
  }
  Factor factor;
  const std::size_t unit = text.starts_with("0x") ? std::string_view::npos : unit_begin(text);
  if (unit != std::string_view::npos) {
    const std::string_view name = without_step(trimmed(text.substr(unit)));
    if (!is_unit(name)) return refused("'{}' is no number", cell);
    factor.unit = name;
    text = trimmed(text.substr(0, unit));
  }
  // "1 x 10-2": the exponent was not raised.
  std::string raised(text);
  const std::size_t ten = text.find("10-");
  if (ten != std::string_view::npos && ten > 1 && contains(" *x", text.substr(ten - 1, 1)))
    raised.insert(ten + 2, "^");
  const auto value = terms(raised, style);
  if (!value && value.error().empty()) return refused("'{}' is no number", cell);
  if (!value) return tl::unexpected(value.error());
  if (*value == 0 || !std::isfinite(*value)) return refused("'{}' is no factor", cell);
  factor.value = *value;
  return factor;
}

std::optional<Factor> factor_of_unit(std::string_view unit, NumberStyle style) {
  if (unit.empty() || !is_digit(unit[0])) return std::nullopt;
  const auto factor = factor_from(unit, style);
  if (!factor || !*factor || (*factor)->value <= 0) return std::nullopt;
  const double places = std::log10((*factor)->value);
  if (std::abs(places - std::round(places)) > 1e-9) return std::nullopt;
  return **factor;
}

std::optional<double> weight_from(std::string_view remark) {
  constexpr std::string_view kBegin = "value weight:";
  const std::size_t at = lower(remark).find(kBegin);
  if (at == std::string::npos) return std::nullopt;
  const auto number = number_from(halves(remark.substr(at + kBegin.size()), '*').second);
  return number && *number > 0 ? number : std::nullopt;
}

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

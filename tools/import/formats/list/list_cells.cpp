#include "tools/import/formats/list/list_cells.hpp"

#include <algorithm>
#include <cmath>

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

// One number, optionally with a bit.
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

// Distance from the first address to the second.
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

// "10^-3", "2^(-7)", or a plain number.
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

// Products and quotients, from left to right.
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

}  // namespace fieldcast::importing

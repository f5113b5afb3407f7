#include "tools/import/formats/list/list_factor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr double kLargestExponent = 18;

using Sign = std::pair<std::string_view, std::string_view>;
constexpr std::array kFactorSigns{Sign{"\u00D7", "*"}, Sign{"\u00B7", "*"}, Sign{"\u22C5", "*"},
                                  Sign{"\u00F7", "/"}, Sign{"\u2212", "-"}, Sign{"\u2013", "-"},
                                  Sign{"\u00A0", " "}, Sign{"**", "^"}};
constexpr std::array kRaised{Sign{"\u2070", "0"}, Sign{"\u00B9", "1"}, Sign{"\u00B2", "2"},
                             Sign{"\u00B3", "3"}, Sign{"\u2074", "4"}, Sign{"\u2075", "5"},
                             Sign{"\u2076", "6"}, Sign{"\u2077", "7"}, Sign{"\u2078", "8"},
                             Sign{"\u2079", "9"}, Sign{"\u207B", "-"}, Sign{"\u207A", ""}};

bool is_numeral(char c) { return c >= '0' && c <= '9'; }

// Replaces typographic signs by ASCII; raised digits after a digit become "^-3".
std::string factor_signs(std::string_view cell) {
  std::string text;
  bool raised = false;
  while (!cell.empty()) {
    const auto up = std::ranges::find_if(
        kRaised, [&](const Sign& sign) { return cell.starts_with(sign.first); });
    const bool behind_digit = raised || (!text.empty() && is_numeral(text.back()));
    if (up != kRaised.end() && behind_digit) {
      if (!std::exchange(raised, true)) text += '^';
      text += up->second;
      cell.remove_prefix(up->first.size());
      continue;
    }
    raised = false;
    const auto sign = std::ranges::find_if(
        kFactorSigns, [&](const Sign& other) { return cell.starts_with(other.first); });
    text += sign == kFactorSigns.end() ? cell.substr(0, 1) : sign->second;
    cell.remove_prefix(sign == kFactorSigns.end() ? 1 : sign->first.size());
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

tl::expected<double, std::string> plain_number(std::string_view text, NumberStyle style) {
  text = trimmed(text);
  const auto number = number_from(text);
  if (!number) return tl::unexpected(std::string());
  if (has_two_meanings(text, style))
    return tl::unexpected(fmt::format("'{}' may be {} or {} thousand", text, *number, *number));
  return *number;
}

// "10^-3", "2^(-7)", or a plain number.
tl::expected<double, std::string> power(std::string_view text, NumberStyle style) {
  text = trimmed(text);
  const std::size_t at = text.find('^');
  if (at == std::string_view::npos) return plain_number(text, style);
  std::string_view raised = trimmed(text.substr(at + 1));
  if (raised.starts_with('(') && raised.ends_with(')'))
    raised = raised.substr(1, raised.size() - 2);
  const auto base = plain_number(text.substr(0, at), style);
  const auto exponent = plain_number(raised, style);
  if (!base || !exponent || *exponent != std::floor(*exponent) ||
      std::abs(*exponent) > kLargestExponent)
    return tl::unexpected(std::string());
  // Exactly 0.001, not a product of tenths.
  if (*base == 10) return number_from(fmt::format("1e{}", static_cast<int>(*exponent))).value_or(0);
  return std::pow(*base, *exponent);
}

// Products and quotients, from left to right.
tl::expected<double, std::string> terms(std::string_view text, NumberStyle style) {
  double value = 1;
  char sign = '*';
  text = trimmed(text);
  if (!text.empty() && std::string_view("xX*/:").find(text[0]) != std::string_view::npos) {
    sign = text[0];
    text = trimmed(text.substr(1));
  }
  for (;;) {
    const std::size_t end =
        text.starts_with("0x") ? text.find_first_of("*/:", 2) : text.find_first_of("xX*/:");
    const auto term = power(text.substr(0, end), style);
    if (!term) return term;
    const bool divide = sign == '/' || sign == ':';
    if (divide && *term == 0) return tl::unexpected(std::string());
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
                          (is_numeral(text[i + 1]) || text[i + 1] == '-' || text[i + 1] == '+');
    const bool sign =
        (c == 'x' || c == 'X') && (i < 2 || text[i - 1] == ' ' || is_numeral(text[i - 1]));
    if (letter && !exponent && !sign) return i;
  }
  return std::string_view::npos;
}

bool is_unit(std::string_view text) {
  return !text.empty() && text.size() <= 12 &&
         text.find_first_of("0123456789,;=*^+.") == std::string_view::npos &&
         text.find(' ') == std::string_view::npos && text != "n";
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
  std::size_t begin = at;
  while (begin > 0 && is_numeral(cell[begin - 1])) --begin;
  const std::size_t digits = end - at - 1;
  const bool certain = digits > 0 && (digits != 3 || at == begin || cell[begin] == '0');
  if (certain) (cell[at] == ',' ? decimal_comma : decimal_point) = true;
}

tl::expected<std::optional<Factor>, std::string> factor_from(std::string_view cell,
                                                             NumberStyle style) {
  const std::string whole = factor_signs(cell);
  std::string_view text = whole;
  const std::string word = lower(text);
  for (const std::string_view none : {"", "-", "--", "none", "n/a", "na", "no", "keine"})
    if (word == none) return std::nullopt;
  // "1 = 0.1": one step of the raw value.
  if (const std::size_t at = text.find('='); at != std::string_view::npos) {
    if (number_from(text.substr(0, at)) != 1.0)
      return tl::unexpected(fmt::format("'{}' is not understood", cell));
    text = trimmed(text.substr(at + 1));
  }
  Factor factor;
  const std::size_t unit = text.starts_with("0x") ? std::string_view::npos : unit_begin(text);
  if (unit != std::string_view::npos) {
    const std::string_view name = without_step(trimmed(text.substr(unit)));
    if (!is_unit(name)) return tl::unexpected(fmt::format("'{}' is no number", cell));
    factor.unit = name;
    text = trimmed(text.substr(0, unit));
  }
  // "1 x 10-2": the exponent was not raised.
  std::string mended(text);
  if (const std::size_t at = text.find("10-");
      at != std::string_view::npos && at > 1 &&
      (text[at - 1] == ' ' || text[at - 1] == '*' || text[at - 1] == 'x'))
    mended.insert(at + 2, "^");
  const auto value = terms(mended, style);
  if (!value)
    return tl::unexpected(value.error().empty() ? fmt::format("'{}' is no number", cell)
                                                : value.error());
  if (*value == 0 || !std::isfinite(*value))
    return tl::unexpected(fmt::format("'{}' is no factor", cell));
  factor.value = *value;
  return factor;
}

std::optional<Factor> factor_of_unit(std::string_view unit, NumberStyle style) {
  if (unit.empty() || !is_numeral(unit[0])) return std::nullopt;
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
  const std::string_view weight = remark.substr(at + kBegin.size());
  const std::size_t sign = weight.find('*');
  if (sign == std::string_view::npos) return std::nullopt;
  const auto number = number_from(trimmed(weight.substr(sign + 1)));
  return number && *number > 0 ? number : std::nullopt;
}

}  // namespace fieldcast::importing

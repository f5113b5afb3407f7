#include "tools/import/text/number.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

std::optional<std::uint64_t> digits_from(std::string_view text, int base) {
  std::uint64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (fault != std::errc{} || text.empty() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<double> number_from(std::string_view text) {
  text = trimmed(text);
  if (const auto hex =
          text.starts_with("0x") || text.starts_with("0X") ? whole_from(text) : std::nullopt)
    return static_cast<double>(*hex);
  std::string plain(text);
  if (plain.find('.') == std::string::npos) {
    const std::size_t comma = plain.find(',');
    if (comma != std::string::npos) plain[comma] = '.';
  }
  if (plain.starts_with('+')) plain.erase(0, 1);
  double number = 0;
  const auto [end, fault] = std::from_chars(plain.data(), plain.data() + plain.size(), number);
  if (fault != std::errc{} || plain.empty() || end != plain.data() + plain.size() ||
      !std::isfinite(number))
    return std::nullopt;
  return number;
}

std::optional<std::uint64_t> whole_from(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with("0x") || text.starts_with("0X")) return digits_from(text.substr(2), 16);
  if (text.starts_with('$')) return digits_from(text.substr(1), 16);
  if (text.ends_with('h') || text.ends_with('H'))
    return digits_from(text.substr(0, text.size() - 1), 16);
  // A spreadsheet may have added decimals.
  for (const char point : {'.', ','}) {
    const std::size_t at = text.find(point);
    if (at != std::string_view::npos && at > 0 &&
        text.find_first_not_of('0', at + 1) == std::string_view::npos)
      text = text.substr(0, at);
  }
  return digits_from(text, 10);
}

}  // namespace fieldcast::importing

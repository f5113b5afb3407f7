#include "tools/cli/direct/address_steps.hpp"

#include <algorithm>
#include <charconv>

namespace fieldcast::cli {

std::optional<std::string> address_behind(const Protocol& protocol, std::string_view at,
                                          std::uint32_t items) {
  if (items == 0) return std::string(at);
  const auto from = protocol.parse_address(at);
  const std::size_t before = at.find_last_not_of("0123456789");
  const std::size_t digits = before == std::string_view::npos ? 0 : before + 1;
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(at.data() + digits, at.data() + at.size(), number);
  if (!from || error != std::errc{}) return std::nullopt;
  std::string text = std::to_string(number + items);
  const std::size_t width = at.size() - digits;
  if (text.size() < width) text.insert(0, width - text.size(), '0');
  text.insert(0, at.substr(0, digits));
  const auto behind = protocol.parse_address(text);
  const bool right = behind && behind->area == from->area && behind->bit == from->bit &&
                     behind->first == from->first + items;
  return right ? std::optional(std::move(text)) : std::nullopt;
}

std::uint32_t values_in_request(const Protocol& protocol, const ParsedAddress& at,
                                std::uint32_t value_items) {
  const Area& area = protocol.areas()[at.area];
  std::uint32_t values = std::max(1u, area.max_read / value_items);
  const auto fits = [&](std::uint32_t count) {
    return protocol.size(ReadRequest{{{at.area, at.first, count * value_items}}}).has_value();
  };
  while (values > 1 && !fits(values)) --values;
  return values;
}

}  // namespace fieldcast::cli

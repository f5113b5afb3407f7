#include "config/sections/port_text.hpp"

#include <charconv>

namespace fieldcast::config {

std::optional<LineFormat> format_from(std::string_view text) {
  if (text.size() != 3 || (text[0] != '7' && text[0] != '8') || (text[2] != '1' && text[2] != '2'))
    return std::nullopt;
  LineFormat format;
  format.data_bits = static_cast<std::uint8_t>(text[0] - '0');
  format.stop_bits = static_cast<std::uint8_t>(text[2] - '0');
  switch (text[1]) {
    case 'N': format.parity = Parity::kNone; return format;
    case 'E': format.parity = Parity::kEven; return format;
    case 'O': format.parity = Parity::kOdd; return format;
    default: return std::nullopt;
  }
}

std::optional<std::pair<std::string, std::uint16_t>> host_port_from(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const std::string_view digits = text.substr(colon + 1);
  std::uint16_t port = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (fault != std::errc{} || end != digits.data() + digits.size() || port == 0)
    return std::nullopt;
  const bool bracketed = host.starts_with('[') && host.ends_with(']');
  if (bracketed) host = host.substr(1, host.size() - 2);
  if (host.empty() || host.size() > 253 || (!bracketed && host.find(':') != std::string_view::npos))
    return std::nullopt;
  for (const char c : host) {
    const bool fits = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                      c == '.' || c == '-' || c == '_' || (bracketed && (c == ':' || c == '%'));
    if (!fits) return std::nullopt;
  }
  return std::pair{std::string(host), port};
}

}  // namespace fieldcast::config

// Texts of lines and addresses that configurations and command lines have in common. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/frame/line.hpp"

namespace fieldcast::config {

// Data bits, parity and stop bits of "8N1".
[[nodiscard]] std::optional<LineFormat> format_from(std::string_view text);

// "10.0.0.7:502", "[::1]:502"; the port is 1..65535.
[[nodiscard]] std::optional<std::pair<std::string, std::uint16_t>> host_port_from(
    std::string_view text);

}  // namespace fieldcast::config

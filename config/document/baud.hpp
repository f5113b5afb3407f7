// The baud rate of a serial line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/document/document.hpp"

namespace fieldcast::config {

struct BaudRule {
  // A fault names the rates, and those that may be meant.
  std::optional<std::uint32_t> operator()(const Node& node, std::string_view key,
                                          FaultList& faults) const;
  [[nodiscard]] static std::string form();
  [[nodiscard]] static std::string schema();
};

}  // namespace fieldcast::config

// Reads the options of a device link; keeps the first fault.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast {

class OptionReader {
 public:
  // Checks the device address, and the option names against `names`.
  OptionReader(const DeviceLink& link, const Traits& traits,
               std::span<const std::string_view> names);

  // "true" or "false".
  bool flag(std::string_view name, bool otherwise);
  // Index of the option's text in `choices`.
  std::size_t choice(std::string_view name, std::initializer_list<std::string_view> choices,
                     std::size_t otherwise = 0);
  std::uint32_t number(std::string_view name, std::uint32_t lowest, std::uint32_t highest,
                       std::uint32_t otherwise);

  [[nodiscard]] const std::optional<OptionFault>& fault() const { return fault_; }

 private:
  const std::string* text_of(std::string_view name) const;
  void refuse(std::string_view name, std::string what, std::string allowed);

  const DeviceLink& link_;
  std::optional<OptionFault> fault_;
};

}  // namespace fieldcast

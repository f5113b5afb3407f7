// Reads the options of a device link: typed, with defaults, and with a fault that says what is
// allowed. The first fault is kept.
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
  // Checks the device's address against the family's, and every option's name against `names`.
  OptionReader(const DeviceLink& link, const Traits& traits,
               std::span<const std::string_view> names);

  // "true" or "false".
  bool flag(std::string_view name, bool otherwise);
  // The index of the option's text among the choices.
  std::size_t choice(std::string_view name, std::initializer_list<std::string_view> choices,
                     std::size_t otherwise = 0);
  // A decimal number.
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

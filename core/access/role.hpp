// Permissions of a user. Each role includes those before it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace fieldcast {

enum class Role : std::uint8_t {
  kViewer,      // read stored data
  kOperator,    // also write values
  kProgrammer,  // also access a device with its programming software
};
inline constexpr std::array kRoles{Role::kViewer, Role::kOperator, Role::kProgrammer};

[[nodiscard]] std::string_view to_text(Role role);  // "viewer", "operator", "programmer"
[[nodiscard]] std::optional<Role> role_from(std::string_view text);
[[nodiscard]] constexpr bool may(Role role, Role needed) { return role >= needed; }

}  // namespace fieldcast

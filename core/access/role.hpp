// What a user may do. Each role may all that the ones before it may.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace fieldcast {

enum class Role : std::uint8_t {
  kViewer,      // look at what is stored
  kOperator,    // and write values
  kProgrammer,  // and reach a device with its programming software
};
inline constexpr std::array kRoles{Role::kViewer, Role::kOperator, Role::kProgrammer};

[[nodiscard]] std::string_view to_text(Role role);  // "viewer", "operator", "programmer"
[[nodiscard]] std::optional<Role> role_from(std::string_view text);
[[nodiscard]] constexpr bool may(Role role, Role needed) { return role >= needed; }

}  // namespace fieldcast

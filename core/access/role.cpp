#include "core/access/role.hpp"

namespace fieldcast {

std::string_view to_text(Role role) {
  switch (role) {
    case Role::kViewer: return "viewer";
    case Role::kOperator: return "operator";
    case Role::kProgrammer: return "programmer";
  }
  return "?";
}

std::optional<Role> role_from(std::string_view text) {
  for (const Role role : kRoles) {
    if (text == to_text(role)) return role;
  }
  return std::nullopt;
}

}  // namespace fieldcast

// The users of a store. Passwords are kept as Argon2id hashes only (libsodium, its interactive
// limits: 64 MiB, some 0.1 s each).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql.hpp"
#include "core/access/role.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct User {
  std::string name;
  Role role = Role::kViewer;
  UtcTime created_at;
};

class UserTable {
 public:
  explicit UserTable(SqlConnection& connection) : connection_(connection) {}

  // Everything throws StoreError. False: there is such a user already.
  [[nodiscard]] bool add(const std::string& name, Role role, std::string_view password,
                         UtcTime now);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none
  [[nodiscard]] std::vector<User> list();              // by name

  // The role, when name and password fit. Takes the same time for a name that is unknown.
  [[nodiscard]] std::optional<Role> verify(const std::string& name, std::string_view password);
  // Of a user who has proven who it is by other means; nothing: there is none.
  [[nodiscard]] std::optional<Role> role_of(const std::string& name);

 private:
  SqlConnection& connection_;
};

// Why a name or a password is not taken; empty: it is.
[[nodiscard]] std::string fault_of_user_name(std::string_view name);
[[nodiscard]] std::string fault_of_password(std::string_view password);

}  // namespace fieldcast

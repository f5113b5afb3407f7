// Users of a store. Passwords are stored only as Argon2id hashes (libsodium, its interactive
// limits: 64 MiB, about 0.1 s each).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/access/login.hpp"
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

  // Everything throws StoreError. Returns false if the user exists already.
  [[nodiscard]] bool add(const std::string& name, Role role, std::string_view password,
                         UtcTime now);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none
  [[nodiscard]] std::vector<User> list();              // sorted by name

  // Returns the role if name and password match. Lasts equally long for an unknown name.
  [[nodiscard]] std::optional<Role> verify(const std::string& name, std::string_view password);
  // Returns the role of a user who was authenticated by other means; `std::nullopt` if unknown.
  [[nodiscard]] std::optional<Role> role_of(const std::string& name);

 private:
  SqlConnection& connection_;
};

// Return why a name or a password is refused; empty if accepted.
[[nodiscard]] std::string fault_of_user_name(std::string_view name);
[[nodiscard]] std::string fault_of_password(std::string_view password);

}  // namespace fieldcast

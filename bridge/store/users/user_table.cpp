#include "bridge/store/users/user_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/store/users/password.hpp"
#include "bridge/store/users/users.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

// For unknown users, the password is verified against this hash, which costs as much as a real one.
const std::string& nobody() {
  static const std::string hash = hash_password("nobody");
  return hash;
}

bool plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || c == '.' || c == '@';
}

}  // namespace

bool UserTable::add(const std::string& name, Role role, std::string_view password, UtcTime now) {
  return connection_.execute(
             "insert into users (name, role, password_hash, created_at) values ($1, $2, $3, $4) on "
             "conflict do nothing",
             SqlRow{name, std::string(to_text(role)), hash_password(password), now.nanoseconds}) ==
         1;
}

bool UserTable::remove(const std::string& name) {
  return connection_.execute("delete from users where name = $1", SqlRow{name}) == 1;
}

std::vector<User> UserTable::list() {
  std::vector<User> users;
  connection_.query(
      "select name, role, created_at from users order by name", {}, [&](const SqlRow& row) {
        const auto role = role_from(text_at(row, 1));
        if (!role)
          throw StoreError(fmt::format("store: user {} has the unknown role {}",
                                       printable(text_at(row, 0)), printable(text_at(row, 1))));
        users.push_back({text_at(row, 0), *role, UtcTime{integer_at(row, 2)}});
        return true;
      });
  return users;
}

std::optional<Role> UserTable::verify(const std::string& name, std::string_view password) {
  std::string hash = nobody();
  std::optional<Role> role;
  connection_.query("select role, password_hash from users where name = $1", SqlRow{name},
                    [&](const SqlRow& row) {
                      role = role_from(text_at(row, 0));
                      hash = text_at(row, 1);
                      return false;
                    });
  return password_fits(hash, password) ? role : std::nullopt;
}

std::optional<Role> UserTable::role_of(const std::string& name) {
  std::optional<Role> role;
  connection_.query("select role from users where name = $1", SqlRow{name}, [&](const SqlRow& row) {
    role = role_from(text_at(row, 0));
    return false;
  });
  return role;
}

std::string fault_of_user_name(std::string_view name) {
  if (!name.empty() && name.size() <= Logins::kMaxUserBytes &&
      std::all_of(name.begin(), name.end(), plain))
    return {};
  return "a user's name has 1 to 64 letters, digits, '-', '_', '.', '@'";
}

std::string fault_of_password(std::string_view password) {
  if (password.size() < Logins::kMinPasswordBytes)
    return fmt::format("a password has at least {} characters", Logins::kMinPasswordBytes);
  if (password.size() > Logins::kMaxPasswordBytes)
    return fmt::format("a password has at most {} bytes", Logins::kMaxPasswordBytes);
  return {};
}

}  // namespace fieldcast

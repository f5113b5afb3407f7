// Tokens of a store: each gives a program or a wall display read access until it expires. A token
// is 256 random bits, shown only at its creation; the store has a fast hash of it, as it cannot be
// guessed. Throws StoreError. One owner, the thread of the connection.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/access/login.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct Token {
  std::string name;  // of the user of the token
  UtcTime created_at;
  UtcTime ends_at;
  friend bool operator==(const Token&, const Token&) = default;
};

// A new token: "fct_" and 43 letters, digits, '-', '_'.
[[nodiscard]] std::string make_token();
// Returns true if the text has the form of a token.
[[nodiscard]] bool looks_like_token(std::string_view text);

class TokenTable {
 public:
  static constexpr std::size_t kMaxTokens = 1000;

  explicit TokenTable(SqlConnection& connection) : connection_(connection) {}

  // Returns false if the name exists already, or if there are kMaxTokens.
  [[nodiscard]] bool add(const Token& token, const std::string& secret);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none
  [[nodiscard]] std::vector<Token> list();             // sorted by name, including expired ones

  // Returns `std::nullopt` if there is no such token, or if it has expired at `now`.
  [[nodiscard]] std::optional<Token> find(const std::string& secret, UtcTime now);

 private:
  SqlConnection& connection_;
};

// Users of a store. Passwords are Argon2id hashes (libsodium's interactive limits: 64 MiB, 0.1 s).
struct User {
  std::string name;
  Role role = Role::kViewer;
  UtcTime created_at;  // of this password: a new one needs remove() and add()
};

class UserTable {
 public:
  explicit UserTable(SqlConnection& connection) : connection_(connection) {}

  // Everything throws StoreError. Returns false if the user exists already.
  [[nodiscard]] bool add(const std::string& name, Role role, std::string_view password,
                         UtcTime now);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none
  [[nodiscard]] std::vector<User> list();              // sorted by name

  // Returns the user if name and password match. Lasts equally long for an unknown name.
  [[nodiscard]] std::optional<User> verify(const std::string& name, std::string_view password);
  // Returns a user who was authenticated by other means; `std::nullopt` if unknown.
  [[nodiscard]] std::optional<User> find(const std::string& name);

 private:
  SqlConnection& connection_;
};

// Return why a name or a password is refused; empty if accepted.
[[nodiscard]] std::string fault_of_user_name(std::string_view name);
[[nodiscard]] std::string fault_of_password(std::string_view password);

}  // namespace fieldcast

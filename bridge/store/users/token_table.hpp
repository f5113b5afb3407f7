// Tokens of a store. Each gives a program or a wall display read access until it expires. A token
// is 256 random bits and is shown only at its creation; the store contains only its hash. A fast
// hash is sufficient, because 256 random bits cannot be guessed.
//
// Functions that access the store throw StoreError. One owner, the thread of the connection.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
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

}  // namespace fieldcast

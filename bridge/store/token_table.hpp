// The tokens of a store: each lets a program or a wall screen read, until its end. A token is 256
// random bits, shown once when it is made; the store keeps its hash only. A fast hash will do:
// nobody guesses 256 bits.
//
// Everything that reads or writes throws StoreError. One owner, the thread of the connection.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct Token {
  std::string name;  // of what uses it
  UtcTime created_at;
  UtcTime ends_at;
  friend bool operator==(const Token&, const Token&) = default;
};

// A new token: "fct_" and 43 letters, digits, '-', '_'.
[[nodiscard]] std::string make_token();
// Whether a text can be one at all.
[[nodiscard]] bool looks_like_token(std::string_view text);

class TokenTable {
 public:
  static constexpr std::size_t kMaxTokens = 1000;

  explicit TokenTable(SqlConnection& connection) : connection_(connection) {}

  // False: there is one of that name already, or there are kMaxTokens.
  [[nodiscard]] bool add(const Token& token, const std::string& secret);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none
  [[nodiscard]] std::vector<Token> list();             // by name, also those that have ended

  // Whose it is; nothing: nobody's, or it has ended at `now`.
  [[nodiscard]] std::optional<Token> find(const std::string& secret, UtcTime now);

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast

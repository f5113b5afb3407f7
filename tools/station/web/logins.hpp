// Stores the logged-in sessions, with only the hash of each cookie's secret of 256 random bits. A
// login ends by logout, after 30 min without use, after 12 h (by token: when that expires), when
// its user is removed or changed, or beyond kMaxLogins. No clock and no randomness; on the io
// thread.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bridge/store/users/authenticator.hpp"
#include "bridge/store/users/user_table.hpp"
#include "core/access/login.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

struct Login {
  std::uint64_t id = 0;  // never reused; 0: none
  std::string user;      // name of the user or of the token
  Role role = Role::kViewer;
  bool by_token = false;
  UtcTime credential_created_at;  // of the password or the token
  Instant ends{};                 // latest end of the login
  Instant last_used{};
};

class SessionStore {
 public:
  // a further login ends the one unused for longest
  static constexpr std::size_t kMaxLogins = 1024;
  static constexpr Duration kIdle = std::chrono::minutes{30};
  static constexpr Duration kWhole = std::chrono::hours{12};
  static constexpr std::size_t kSecretBytes = 32;
  using Secret = std::array<unsigned char, kSecretBytes>;

  // Calls `ended(id)` for each login that ends. The callback must not call this object.
  explicit SessionStore(std::function<void(std::uint64_t id)> ended) : ended_(std::move(ended)) {}

  // Returns the text for the cookie. `random`: new system randomness, used once. Sets `login.id`
  // and `last_used`, and limits `ends` to kWhole unless by token.
  [[nodiscard]] std::string begin(Login login, const Secret& random, Instant now);

  // Counts as use. Null if unknown or expired. Valid until the next call of this object.
  [[nodiscard]] const Login* find(std::string_view cookie, Instant now);
  // Counts as use without a request: the page has an open connection.
  void touch(std::uint64_t id, Instant now);

  void end(std::string_view cookie);
  void end_expired(Instant now);

  // Ends logins that match no user of the store. A new password has another created_at, which may
  // be earlier: the clock can be set back, and the clocks of two hosts differ.
  void users_are(std::span<const User> users);
  // Ends logins that match no token of the list. A new token may have the name of a removed one.
  void tokens_are(std::span<const Token> tokens);

  [[nodiscard]] std::size_t size() const { return logins_.size(); }

 private:
  using Hash = std::array<unsigned char, 32>;
  using Logins = std::map<Hash, Login>;
  [[nodiscard]] static std::optional<Hash> hash_of(std::string_view cookie);
  Logins::iterator erase(Logins::iterator at);
  template <typename Rule>
  void end_where(Rule rule);

  const std::function<void(std::uint64_t)> ended_;
  Logins logins_;
  std::uint64_t last_id_ = 0;
};

struct LoginGrant {
  std::string user;  // name of the user or of the token
  Role role = Role::kViewer;
  Duration left = SessionStore::kWhole;  // time until the login ends; for a token, until it expires
  bool by_token = false;
  UtcTime credential_created_at{};
};
using LoginVerdict = tl::expected<LoginGrant, LoginRefused>;

// Call `done` once, on the io thread, immediately or later. Empty without users or tokens.
struct LoginCheck {
  std::function<void(LoginAttempt, std::function<void(LoginVerdict)> done)> by_password;
  std::function<void(std::string token, std::string peer, std::function<void(LoginVerdict)> done)>
      by_token;
  std::function<SessionStore::Secret()> random;
};

}  // namespace fieldcast::web

// Who is logged in: secrets of 256 random bits in cookies, of which only the hashes are kept here.
// A login ends by logout, after 30 min without use, after 12 h in all (that of a token: at the
// token's own end), when its user is gone or has another role, and when too many newer ones came.
// Pure but for its memory: no clock, no randomness. Lives on the io thread.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/access/role.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

struct Login {
  std::uint64_t id = 0;  // never reused; 0 is none
  std::string user;      // of a token: its name
  Role role = Role::kViewer;
  bool by_token = false;
  UtcTime begun_at;
  Instant ends{};  // whatever happens
  Instant last_used{};
};

class SessionBook {
 public:
  static constexpr std::size_t kMaxLogins = 1024;  // one more ends the one unused for longest
  static constexpr Duration kIdle = std::chrono::minutes{30};
  static constexpr Duration kWhole = std::chrono::hours{12};
  static constexpr std::size_t kSecretBytes = 32;
  using Secret = std::array<unsigned char, kSecretBytes>;

  // `ended` is told the id of each login that has ended. It must not call back.
  explicit SessionBook(std::function<void(std::uint64_t id)> ended) : ended_(std::move(ended)) {}

  // Puts the login in, and gives the text for its cookie. `random` is fresh from the system, and
  // used once. `login.id` and `last_used` are filled in here; `ends` is cut to kWhole, except that
  // of a token.
  [[nodiscard]] std::string begin(Login login, const Secret& random, Instant now);

  // Whose cookie it is; counts as a use. Null: nobody's, or it has ended. Valid until the next call
  // of anything here.
  [[nodiscard]] const Login* find(std::string_view cookie, Instant now);
  // A use without a request: its page has an open connection.
  void touch(std::uint64_t id, Instant now);

  void end(std::string_view cookie);
  void end_expired(Instant now);

  // What the store says of users at present: logins that fit none of them end. One whose password
  // was set anew (the user was made after the login) has to log in again.
  struct KnownUser {
    std::string name;
    Role role;
    UtcTime created_at;
  };
  void users_are(std::span<const KnownUser> users);
  // The same of tokens, by their names.
  void tokens_are(std::span<const std::string> names);

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

}  // namespace fieldcast::web

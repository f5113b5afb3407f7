// Logins of users: checks whether a user with this password may log in.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"
#include "core/access/login.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct LoginAttempt {
  std::string user;
  Secret password;
  // The peer's address without the port. Attempts are throttled by user and by peer.
  std::string peer;
  bool certified = false;  // by a verified certificate; there is no password to check
};

struct LoginRefused {
  enum class Why : std::uint8_t {
    kWrong,        // unknown user or wrong password: same response after the same time
    kUnknown,      // the user of a certificate is not in the store
    kTooSoon,      // after wrong passwords: not checked before `wait` has passed
    kBusy,         // too many other logins are waiting
    kUnavailable,  // the store is not available, or there is none
  };
  Why why = Why::kUnavailable;
  Duration wait{};  // with kTooSoon
};
// One human-readable line, also for the audit; contains no secret.
[[nodiscard]] std::string to_text(const LoginRefused& refused);

using LoginResult = tl::expected<Role, LoginRefused>;

class Logins {
 public:
  static constexpr std::size_t kMaxWaiting = 16;       // attempts; more are refused as busy
  static constexpr std::size_t kMaxUserBytes = 64;     // of a name
  static constexpr std::size_t kMinPasswordBytes = 8;  // of a new one
  static constexpr std::size_t kMaxPasswordBytes = 1024;

  virtual ~Logins() = default;
  // Any thread; never blocks. `done` is called exactly once within 30 s: immediately, or on a
  // thread of the logins, where it must only post. Every attempt is audited.
  virtual void authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) = 0;
};

}  // namespace fieldcast

// The logins of users: whether a user with this password may log in.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"
#include "core/access/role.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct LoginAttempt {
  std::string user;
  Secret password;
  // The address it comes from, without the port: guessing is slowed down by user and peer.
  std::string peer;
  bool certified = false;  // by a certificate that was verified: there is no password to check
};

struct LoginRefused {
  enum class Why : std::uint8_t {
    kWrong,        // no such user, or another password: the same answer after the same time
    kUnknown,      // the user of a certificate is none of ours
    kTooSoon,      // after wrong passwords: not checked before `wait` is over
    kBusy,         // too many others log in
    kUnavailable,  // the store cannot be asked, or there is none
  };
  Why why = Why::kUnavailable;
  Duration wait{};  // with kTooSoon
};
// One line for people and for the audit; no secret in it.
[[nodiscard]] std::string to_text(const LoginRefused& refused);

using LoginResult = tl::expected<Role, LoginRefused>;

class Logins {
 public:
  static constexpr std::size_t kMaxWaiting = 16;       // attempts; one more is refused as busy
  static constexpr std::size_t kMaxUserBytes = 64;     // of a name
  static constexpr std::size_t kMinPasswordBytes = 8;  // of a new one
  static constexpr std::size_t kMaxPasswordBytes = 1024;

  virtual ~Logins() = default;
  // Any thread; never blocks. `done` is called exactly once, within 30 s: at once for an attempt
  // that need not be checked, else on a thread of the logins, where it must only post. Every
  // attempt is audited.
  virtual void authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) = 0;
};

}  // namespace fieldcast

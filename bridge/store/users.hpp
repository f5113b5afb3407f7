// Who may log in, and the one question that others ask: may this user, with this password?
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/access/role.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct LoginAttempt {
  std::string user;
  std::string password;
  std::string peer;  // the address it comes from, without the port: guessing is slowed down by user
                     // and peer
};

struct LoginRefused {
  enum class Why : std::uint8_t {
    kWrong,        // no such user, or another password: the same answer after the same time
    kTooSoon,      // after wrong passwords: not looked at before `wait` is over
    kBusy,         // too many others log in
    kUnavailable,  // the store cannot be asked, or there is none
  };
  Why why = Why::kUnavailable;
  Duration wait{};  // with kTooSoon
};
[[nodiscard]] std::string to_text(
    const LoginRefused& refused);  // one line for people and for the audit; no secret in it

using LoginResult = tl::expected<Role, LoginRefused>;

class Logins {
 public:
  static constexpr std::size_t kMaxWaiting = 16;       // attempts; one more is refused as busy
  static constexpr std::size_t kMaxUserBytes = 64;     // of a name
  static constexpr std::size_t kMinPasswordBytes = 8;  // of a new one
  static constexpr std::size_t kMaxPasswordBytes = 1024;

  virtual ~Logins() = default;
  // Any thread; never blocks. `done` is called exactly once, within 30 s: at once for what needs no
  // thought, else on a thread of the logins, where it must only post. Every attempt is audited.
  virtual void authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) = 0;
};

}  // namespace fieldcast

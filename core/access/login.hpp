// Permissions of a user. Each role includes those before it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

enum class Role : std::uint8_t {
  kViewer,      // read stored data
  kOperator,    // also write values
  kProgrammer,  // also access a device with its programming software
  kEngineer,    // also change configurations and dashboards
};
inline constexpr std::array kRoles{Role::kViewer, Role::kOperator, Role::kProgrammer,
                                   Role::kEngineer};

[[nodiscard]] std::string_view to_text(Role role);  // "viewer", "operator", ...
[[nodiscard]] std::optional<Role> role_from(std::string_view text);
[[nodiscard]] constexpr bool may(Role role, Role needed) { return role >= needed; }

// Limits password guessing: each wrong password after the first few delays the next attempt, from 1
// s up to 5 min. An early attempt is rejected without a password check. Pure; one owner. Failures
// count per user and peer, so that an attacker elsewhere cannot lock out the user, and per peer
// with a higher limit. All addresses of an IPv6 /64 are one peer, as one host can use all of them.
class LoginThrottle {
 public:
  static constexpr unsigned kFreeOfUser = 3;  // wrong passwords before the first delay
  static constexpr unsigned kFreeOfPeer = 10;
  static constexpr Duration kFirst = std::chrono::seconds{1};
  static constexpr Duration kLongest = std::chrono::minutes{5};
  static constexpr Duration kForget = std::chrono::minutes{30};  // without a wrong password
  static constexpr std::size_t kMaxKeys = 4096;

  // Zero if the next attempt is allowed now.
  [[nodiscard]] Duration wait(std::string_view user, std::string_view peer, Instant now) const;
  void failed(std::string_view user, std::string_view peer, Instant now);
  // Keeps the peer's count: one valid account must not allow the peer to guess all others.
  void succeeded(std::string_view user, std::string_view peer);

 private:
  struct Count {
    unsigned failures = 0;
    Instant last{};
    Instant open{};  // earliest next attempt
  };
  void note(const std::string& key, unsigned free, Instant now);
  [[nodiscard]] Duration wait_of(const std::string& key, Instant now) const;

  std::map<std::string, Count> counts_;
};

}  // namespace fieldcast

// Functions of the site to verify a login.
#pragma once

#include <functional>
#include <string>

#include "bridge/store/users/users.hpp"
#include "core/access/login.hpp"
#include "core/base/time.hpp"
#include "tools/station/web/session_store.hpp"

namespace fieldcast::web {

struct LoginGrant {
  std::string user;  // name of the user or of the token
  Role role = Role::kViewer;
  Duration left = SessionStore::kWhole;  // time until the login ends; for a token, until it expires
  bool by_token = false;
};
using LoginVerdict = tl::expected<LoginGrant, LoginRefused>;

// Call `done` once, on the io thread, immediately or later. Empty without users or tokens.
struct LoginCheck {
  std::function<void(LoginAttempt, std::function<void(LoginVerdict)> done)> by_password;
  std::function<void(std::string token, std::string peer, std::function<void(LoginVerdict)> done)>
      by_token;
  // 32 bytes of the system's random generator.
  std::function<SessionStore::Secret()> random;
};

}  // namespace fieldcast::web

// How the site asks whether a login is right. Answers come on the io thread.
#pragma once

#include <functional>
#include <string>

#include "bridge/store/users.hpp"
#include "core/access/role.hpp"
#include "core/base/time.hpp"
#include "tools/station/web/session_book.hpp"

namespace fieldcast::web {

struct LoginGrant {
  std::string user;  // of a token: its name
  Role role = Role::kViewer;
  Duration left = SessionBook::kWhole;  // until it ends; a token's own end
  bool by_token = false;
};
using LoginVerdict = tl::expected<LoginGrant, LoginRefused>;

// Each calls `done` once, on the io thread, at once or later. Empty: there are no users, or no
// tokens.
struct LoginCheck {
  std::function<void(LoginAttempt, std::function<void(LoginVerdict)> done)> by_password;
  std::function<void(std::string token, std::string peer, std::function<void(LoginVerdict)> done)>
      by_token;
  // 32 bytes of the system's randomness.
  std::function<SessionBook::Secret()> random;
};

}  // namespace fieldcast::web

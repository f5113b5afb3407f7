// Logins by token: looks the token up in the store. On the io thread; never blocks. Every attempt
// is audited, with the token's name and never with the token. A peer that sends wrong ones has to
// wait.
#pragma once

#include "bridge/store/audit.hpp"
#include "core/access/login_throttle.hpp"
#include "tools/station/api/database.hpp"
#include "tools/station/web/login_check.hpp"

namespace fieldcast::web {

class Tokens {
 public:
  // Database and audit outlive it.
  Tokens(Database& database, Audit& audit, std::function<UtcTime()> utc,
         std::function<Instant()> now)
      : database_(database), audit_(audit), utc_(std::move(utc)), now_(std::move(now)) {}
  Tokens(const Tokens&) = delete;
  Tokens& operator=(const Tokens&) = delete;

  // `done` is called once, on the io thread, at once or later, also when this object is gone by
  // then. What a token lets in may read, and no more.
  void check(std::string token, const std::string& peer, std::function<void(LoginVerdict)> done);

  // The names of those that have not ended, for logins that go on; nothing: the store cannot be
  // asked now.
  void names(std::function<void(std::optional<std::vector<std::string>>)> done);

 private:
  struct Shared {
    LoginThrottle throttle;
  };
  Database& database_;
  Audit& audit_;
  const std::function<UtcTime()> utc_;
  const std::function<Instant()> now_;
  const std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

}  // namespace fieldcast::web

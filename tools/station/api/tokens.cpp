#include "tools/station/api/tokens.hpp"

#include "bridge/store/users/password.hpp"
#include "bridge/store/users/token_table.hpp"

namespace fieldcast::web {
namespace {

constexpr std::string_view kWhat = "token";  // replaces the user name in the audit log

LoginVerdict refused(LoginRefused::Why why, Duration wait = {}) {
  return tl::make_unexpected(LoginRefused{why, wait});
}

LoginRefused::Why why_of(DatabaseFault fault) {
  return fault == DatabaseFault::kBusy ? LoginRefused::Why::kBusy : LoginRefused::Why::kUnavailable;
}

void note(Audit& audit, const std::string& name, const std::string& peer,
          const LoginVerdict& verdict) {
  audit.append({.who = (name.empty() ? std::string("a token") : "token " + name) +
                       (peer.empty() ? "" : " from " + peer),
                .what = "login",
                .result = verdict ? "done" : "refused: " + to_text(verdict.error())});
}

}  // namespace

void Tokens::check(std::string token, const std::string& peer,
                   std::function<void(LoginVerdict)> done) {
  const Duration wait = shared_->throttle.wait(kWhat, peer, now_());
  if (wait > Duration{} || !looks_like_token(token)) {
    wipe(token);
    const auto verdict = wait > Duration{} ? refused(LoginRefused::Why::kTooSoon, wait)
                                           : refused(LoginRefused::Why::kWrong);
    if (wait <= Duration{}) shared_->throttle.failed(kWhat, peer, now_());
    note(audit_, {}, peer, verdict);
    return done(verdict);
  }
  using Found = std::optional<Token>;
  const auto secret = std::make_shared<std::string>(std::move(token));
  database_.ask<Found>(
      [secret, at = utc_()](SqlConnection& connection) {
        Found found = TokenTable(connection).find(*secret, at);
        wipe(*secret);
        return found;
      },
      [&audit = audit_, shared = shared_, now = now_, utc = utc_, peer,
       done = std::move(done)](const tl::expected<Found, DatabaseFault>& found) {
        LoginVerdict verdict = refused(LoginRefused::Why::kWrong);
        std::string name;
        if (!found) {
          verdict = refused(why_of(found.error()));
        } else if (*found) {
          name = (*found)->name;
          verdict = LoginGrant{.user = name,
                               .role = Role::kViewer,
                               .left = Duration{(*found)->ends_at.nanoseconds - utc().nanoseconds},
                               .by_token = true};
          shared->throttle.succeeded(kWhat, peer);
        } else {
          shared->throttle.failed(kWhat, peer, now());
        }
        note(audit, name, peer, verdict);
        done(verdict);
      });
}

void Tokens::names(std::function<void(std::optional<std::vector<std::string>>)> done) {
  using Names = std::vector<std::string>;
  database_.ask<Names>(
      [at = utc_()](SqlConnection& connection) {
        Names names;
        for (const Token& each : TokenTable(connection).list()) {
          if (each.ends_at > at) names.push_back(each.name);
        }
        return names;
      },
      [done = std::move(done)](tl::expected<Names, DatabaseFault> names) {
        done(names ? std::optional(*std::move(names)) : std::nullopt);
      });
}

}  // namespace fieldcast::web

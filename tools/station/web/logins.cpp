#include "tools/station/web/logins.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/json.hpp"
#include "tools/station/web/route_table.hpp"
#include "tools/station/web/site.hpp"

namespace fieldcast::web {

namespace {

constexpr std::string_view kHexDigits = "0123456789abcdef";

std::string hex_of(const SessionStore::Secret& secret) {
  std::string text;
  text.reserve(2 * secret.size());
  for (const unsigned char byte : secret) {
    text += kHexDigits[byte >> 4];
    text += kHexDigits[byte & 15];
  }
  return text;
}

bool has_expired(const Login& login, Instant now) {
  return now >= login.ends || (!login.by_token && now - login.last_used >= SessionStore::kIdle);
}

}  // namespace

// Hashes the text of the cookie, not the decoded bytes. Empty if its size is wrong.
std::optional<SessionStore::Hash> SessionStore::hash_of(std::string_view cookie) {
  if (cookie.size() != 2 * kSecretBytes) return std::nullopt;
  Hash hash;
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(cookie.data()),
                     cookie.size());
  return hash;
}

std::string SessionStore::begin(Login login, const Secret& random, Instant now) {
  end_expired(now);
  if (logins_.size() >= kMaxLogins) {
    erase(std::ranges::min_element(logins_, {},
                                   [](const auto& each) { return each.second.last_used; }));
  }
  std::string cookie = hex_of(random);
  login.id = ++last_id_;
  login.last_used = now;
  if (!login.by_token) login.ends = now + kWhole;
  logins_.insert_or_assign(*hash_of(cookie), std::move(login));
  return cookie;
}

const Login* SessionStore::find(std::string_view cookie, Instant now) {
  const auto hash = hash_of(cookie);
  const auto found = hash ? logins_.find(*hash) : logins_.end();
  if (found == logins_.end()) return nullptr;
  if (has_expired(found->second, now)) {
    erase(found);
    return nullptr;
  }
  found->second.last_used = now;
  return &found->second;
}

void SessionStore::touch(std::uint64_t id, Instant now) {
  for (auto& [hash, login] : logins_) {
    if (login.id == id) login.last_used = now;
  }
}

void SessionStore::end(std::string_view cookie) {
  const auto hash = hash_of(cookie);
  if (const auto found = hash ? logins_.find(*hash) : logins_.end(); found != logins_.end())
    erase(found);
}

void SessionStore::end_expired(Instant now) {
  end_where([now](const Login& login) { return has_expired(login, now); });
}

void SessionStore::users_are(std::span<const User> users) {
  end_where([users](const Login& login) {
    if (login.by_token) return false;
    const auto known = std::ranges::find(users, login.user, &User::name);
    return known == users.end() || known->role != login.role ||
           known->created_at != login.credential_created_at;
  });
}

void SessionStore::tokens_are(std::span<const Token> tokens) {
  end_where([tokens](const Login& login) {
    if (!login.by_token) return false;
    const auto known = std::ranges::find(tokens, login.user, &Token::name);
    return known == tokens.end() || known->created_at != login.credential_created_at;
  });
}

SessionStore::Logins::iterator SessionStore::erase(Logins::iterator at) {
  const std::uint64_t id = at->second.id;
  const auto next = logins_.erase(at);
  if (ended_) ended_(id);
  return next;
}

template <typename Rule>
void SessionStore::end_where(Rule rule) {
  for (auto at = logins_.begin(); at != logins_.end();) at = rule(at->second) ? erase(at) : ++at;
}

namespace {

constexpr std::size_t kMaxTokenBytes = 256;

double whole_ms(UtcTime at) { return static_cast<double>(at.nanoseconds / 1'000'000); }

HttpResponse json_response(const Json& json) {
  HttpResponse response;
  response.body = json.text();
  return response;
}

HttpResponse response_of(const LoginRefused& refused) {
  using Why = LoginRefused::Why;
  switch (refused.why) {
    case Why::kWrong:
    case Why::kUnknown: return error_response(401, "wrong user or password", "try again");
    case Why::kTooSoon: {
      const auto seconds = std::chrono::ceil<std::chrono::seconds>(refused.wait).count();
      HttpResponse response = error_response(429, "too many wrong passwords",
                                             fmt::format("try again in {} s", seconds));
      response.headers.emplace_back("retry-after", std::to_string(seconds));
      return response;
    }
    case Why::kBusy:
    case Why::kUnavailable: break;
  }
  HttpResponse response = error_response(503, to_text(refused), "try again in some seconds");
  response.headers.emplace_back("retry-after", "5");
  return response;
}

}  // namespace

void Site::add_own_routes() {
  routes_.add({Method::kGet, "/healthz", Access::kPublic,
               [](const HttpRequest&, const Caller&, const Reply& reply) {
                 HttpResponse response;
                 response.content_type = "text/plain; charset=utf-8";
                 response.body = "ok\n";
                 reply(std::move(response));
               }});
  routes_.add({Method::kGet, "/api/me", Access::kPublic,
               [this](const HttpRequest& request, const Caller&, const Reply& reply) {
                 reply(me(request));
               }});
  routes_.add({Method::kPost, "/api/login", Access::kPublic,
               [this](const HttpRequest& request, const Caller& caller, const Reply& reply) {
                 log_in(request, caller, reply);
               }});
  routes_.add({Method::kPost, "/api/logout", Access::kViewer,
               [this](const HttpRequest& request, const Caller&, const Reply& reply) {
                 log_out(request, reply);
               }});
}

HttpResponse Site::me(const HttpRequest& request) {
  std::optional<std::string_view> user, role;
  std::string_view login_kind = "required";
  std::optional<double> expires_ms;
  const Instant now = clock_.now();
  const UtcTime utc = clock_.utc();
  if (const Login* login = book_.find(request.login, now)) {
    user = login->user;
    role = to_text(login->role);
    login_kind = login->by_token ? "token" : "session";
    expires_ms = whole_ms({utc.nanoseconds + (login->ends - now).count()});
  } else if (local_role_) {
    user = "local";
    role = to_text(*local_role_);
    login_kind = "none";
  }
  return json_response({{"user", user},
                        {"role", role},
                        {"login", login_kind},
                        {"expires_ms", expires_ms},
                        {"version", spec_.version},
                        {"store", spec_.store},
                        {"now_ms", whole_ms(utc)}});
}

void Site::log_in(const HttpRequest& request, const Caller& caller, const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  const auto done = [this, cookie = request.login, reply](LoginVerdict verdict) {
    finish_login(cookie, reply, std::move(verdict));
  };
  if (auto token = text_in(*body, "token", kMaxTokenBytes)) {
    if (!logins_.by_token)
      return reply(error_response(401, "there are no tokens", "the station needs a store"));
    return logins_.by_token(std::move(*token), caller.peer, done);
  }
  auto user = text_in(*body, "user", Logins::kMaxUserBytes);
  auto password = text_in(*body, "password", Logins::kMaxPasswordBytes);
  if (!user || !password)
    return reply(
        error_response(400, "no user and password", R"({"user": "..", "password": ".."})"));
  if (!logins_.by_password)
    return reply(error_response(401, "there are no users", "the station needs a store"));
  logins_.by_password({std::move(*user), Secret::taken_from(*password), caller.peer}, done);
}

// A cookie from before the login is invalid afterwards (session fixation).
void Site::finish_login(const std::string& old_cookie, const Reply& reply, LoginVerdict verdict) {
  if (!verdict) return reply(response_of(verdict.error()));
  book_.end(old_cookie);
  const Instant now = clock_.now();
  const UtcTime utc = clock_.utc();
  const Duration left = verdict->by_token ? verdict->left : SessionStore::kWhole;
  const std::string secret = book_.begin({0, verdict->user, verdict->role, verdict->by_token,
                                          verdict->credential_created_at, now + left, now},
                                         logins_.random(), now);
  HttpResponse response =
      json_response({{"user", verdict->user},
                     {"role", to_text(verdict->role)},
                     {"expires_ms", whole_ms({utc.nanoseconds + left.count()})}});
  response.headers.emplace_back("set-cookie", cookie_header(secret, left));
  reply(std::move(response));
}

void Site::log_out(const HttpRequest& request, const Reply& reply) {
  book_.end(request.login);
  HttpResponse response;
  response.status = 204;
  response.headers.emplace_back("set-cookie", cookie_header({}, Duration{}));
  reply(std::move(response));
}

}  // namespace fieldcast::web

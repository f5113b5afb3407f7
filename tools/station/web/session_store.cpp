#include "tools/station/web/session_store.hpp"

#include <sodium.h>

#include <algorithm>

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

void SessionStore::users_are(std::span<const KnownUser> users) {
  end_where([users](const Login& login) {
    if (login.by_token) return false;
    const auto known = std::ranges::find(users, login.user, &KnownUser::name);
    return known == users.end() || known->role != login.role || known->created_at > login.begun_at;
  });
}

void SessionStore::tokens_are(std::span<const std::string> names) {
  end_where([names](const Login& login) {
    return login.by_token && std::ranges::find(names, login.user) == names.end();
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

}  // namespace fieldcast::web

#include "bridge/store/users/authenticator.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/access/network.hpp"

namespace fieldcast {

namespace {

// Makes a name from the network safe for the audit.
std::string shown(const std::string& name) {
  std::string text = name.substr(0, Logins::kMaxUserBytes);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7F; }, '?');
  return text;
}

LoginResult refused(LoginRefused::Why why, Duration wait = {}) {
  return tl::make_unexpected(LoginRefused{why, wait});
}

}  // namespace

std::string to_text(const LoginRefused& refused) {
  switch (refused.why) {
    case LoginRefused::Why::kWrong: return "wrong user or password";
    case LoginRefused::Why::kUnknown: return "there is no such user";
    case LoginRefused::Why::kTooSoon:
      return "too many wrong passwords, try again in " +
             to_text(std::chrono::ceil<std::chrono::seconds>(refused.wait));
    case LoginRefused::Why::kBusy: return "too many others log in";
    case LoginRefused::Why::kUnavailable: return "the users cannot be looked up";
  }
  return "refused";
}

Authenticator::Authenticator(StoreAddress address, Audit& audit)
    : address_(std::move(address)),
      audit_(audit),
      worker_("logins", kMaxWaiting, [this](BoundedQueue<Waiting>& queue) { run(queue); }) {}

Authenticator::~Authenticator() { worker_.close(); }

void Authenticator::authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) {
  Waiting waiting{std::move(attempt), std::move(done)};
  const LoginAttempt& given = waiting.attempt;
  // Cannot be a user of the store: refused without a check and not counted.
  if (!fault_of_user_name(given.user).empty() || given.password.size() > kMaxPasswordBytes)
    return refuse(std::move(waiting), LoginRefused::Why::kWrong);
  if (const Duration wait = throttled(given); wait > Duration{})
    return refuse(std::move(waiting), LoginRefused::Why::kTooSoon, wait);
  if (!worker_.queue().try_put(waiting)) refuse(std::move(waiting), LoginRefused::Why::kBusy);
}

void Authenticator::run(BoundedQueue<Waiting>& queue) {
  while (!queue.closed()) {
    if (auto next = queue.take()) handle(*std::move(next), queue);
  }
  refuse_all(queue);
}

void Authenticator::handle(Waiting next, BoundedQueue<Waiting>& queue) {
  if (queue.closed()) return finish(std::move(next), refused(LoginRefused::Why::kUnavailable));
  const LoginAttempt& attempt = next.attempt;
  // Attempts that were sent together wait here; those after the third wrong one are too soon.
  if (const Duration wait = throttled(attempt); wait > Duration{})
    return refuse(std::move(next), LoginRefused::Why::kTooSoon, wait);
  const LoginResult result = verdict(attempt);
  count(attempt, result);
  finish(std::move(next), result);
  // If the store does not respond, its timeout is waited for once, not for each attempt.
  if (!result && result.error().why == LoginRefused::Why::kUnavailable) refuse_all(queue);
}

Duration Authenticator::throttled(const LoginAttempt& attempt) {
  if (attempt.certified) return {};  // no password to guess
  const std::lock_guard lock(mutex_);
  return throttle_.wait(attempt.user, attempt.peer, steady_now());
}

void Authenticator::count(const LoginAttempt& attempt, const LoginResult& result) {
  if (attempt.certified) return;
  const std::lock_guard lock(mutex_);
  if (result) throttle_.succeeded(attempt.user, attempt.peer);
  if (!result && result.error().why == LoginRefused::Why::kWrong)
    throttle_.failed(attempt.user, attempt.peer, steady_now());
  (void)unchecked_.recovered(access::address_group(attempt.peer));
}

void Authenticator::refuse(Waiting waiting, LoginRefused::Why why, Duration wait) {
  bool is_first = false;
  {
    const std::lock_guard lock(mutex_);
    is_first = unchecked_.occurred(access::address_group(waiting.attempt.peer), steady_now()).log;
  }
  const LoginResult result = refused(why, wait);
  is_first ? finish(std::move(waiting), result) : waiting.done(result);
}

void Authenticator::refuse_all(BoundedQueue<Waiting>& queue) {
  for (Waiting& waiting : queue.take_present())
    finish(std::move(waiting), refused(LoginRefused::Why::kUnavailable));
}

LoginResult Authenticator::verdict(const LoginAttempt& attempt) {
  try {
    if (!connection_) connection_ = open_store(address_, IfMissing::kFail);
    UserTable users(*connection_);
    auto user = attempt.certified ? users.find(attempt.user)
                                  : users.verify(attempt.user, attempt.password.text());
    if (user) return *std::move(user);
    return refused(attempt.certified ? LoginRefused::Why::kUnknown : LoginRefused::Why::kWrong);
  } catch (const StoreError& error) {
    connection_.reset();
    log_counted(LogLevel::kError, "logins", "logins without the store", error.what());
    return refused(LoginRefused::Why::kUnavailable);
  }
}

void Authenticator::finish(Waiting waiting, const LoginResult& result) {
  waiting.attempt.password = {};
  const std::string who =
      shown(waiting.attempt.user) +
      (waiting.attempt.peer.empty() ? "" : " from " + shown(waiting.attempt.peer));
  audit_.append({.who = who,
                 .what = waiting.attempt.certified ? "login by certificate" : "login",
                 .result = result ? "done" : "refused: " + to_text(result.error())});
  waiting.done(result);
}

namespace {

void start_sodium() {
  static const int started = sodium_init();  // may be called repeatedly, from any thread
  FIELDCAST_CHECK(started >= 0);
}

constexpr std::uint64_t kMostKibibytes = 16 * crypto_pwhash_MEMLIMIT_INTERACTIVE / 1024;
constexpr std::uint64_t kMostPasses = 16 * crypto_pwhash_OPSLIMIT_INTERACTIVE;

// Removes `name` and the following number from the front of `text` and returns the number.
std::optional<std::uint64_t> take_number(std::string_view& text, std::string_view name) {
  if (!text.starts_with(name)) return std::nullopt;
  text.remove_prefix(name.size());
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

std::string hash_password(std::string_view password) {
  start_sodium();
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  if (crypto_pwhash_str_alg(hash.data(), password.data(), password.size(),
                            crypto_pwhash_OPSLIMIT_INTERACTIVE, crypto_pwhash_MEMLIMIT_INTERACTIVE,
                            crypto_pwhash_ALG_ARGON2ID13) != 0) {
    throw StoreError("password: no memory for its hash (64 MiB are needed)");
  }
  return hash.data();
}

std::optional<PasswordLimits> password_limits(std::string_view hash) {
  if (!take_number(hash, "$argon2id$v=")) return std::nullopt;
  const auto memory = take_number(hash, "$m="), passes = take_number(hash, ",t=");
  if (!memory || !passes || *memory > kMostKibibytes || *passes > kMostPasses) return std::nullopt;
  return PasswordLimits{*memory, *passes};
}

bool password_fits(const std::string& hash, std::string_view password) {
  start_sodium();
  if (password.empty()) password = "";  // libsodium takes no null pointer
  return password_limits(hash).has_value() &&
         crypto_pwhash_str_verify(hash.c_str(), password.data(), password.size()) == 0;
}

}  // namespace fieldcast

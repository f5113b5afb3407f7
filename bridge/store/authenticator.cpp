#include "bridge/store/authenticator.hpp"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "bridge/bus/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/password.hpp"
#include "bridge/store/user_table.hpp"

namespace fieldcast {
namespace {

// Names come from the network, and go into the audit.
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
    case LoginRefused::Why::kTooSoon:
      return "too many wrong passwords, try again in " +
             to_text(std::chrono::ceil<std::chrono::seconds>(refused.wait));
    case LoginRefused::Why::kBusy: return "too many others log in";
    case LoginRefused::Why::kUnavailable: return "the users cannot be looked up";
  }
  return "refused";
}

Authenticator::Authenticator(StoreAddress address, Audit& audit)
    : address_(std::move(address)), audit_(audit), thread_([this] { run(); }) {}

Authenticator::~Authenticator() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  thread_.join();
  std::unique_lock lock(mutex_);
  turn_away(lock);
}

void Authenticator::authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) {
  Waiting waiting{std::move(attempt), std::move(done)};
  LoginResult answer = refused(LoginRefused::Why::kBusy);
  {
    const std::lock_guard lock(mutex_);
    const Duration wait = throttle_.wait(waiting.attempt.user, waiting.attempt.peer, steady_now());
    if (!fault_of_user_name(waiting.attempt.user).empty() ||
        waiting.attempt.password.size() > kMaxPasswordBytes) {
      answer = refused(
          LoginRefused::Why::kWrong);  // cannot be one of ours: costs nothing, and is not counted
    } else if (wait > Duration{}) {
      answer = refused(LoginRefused::Why::kTooSoon, wait);
    } else if (waiting_.size() < kMaxWaiting && !ending_) {
      waiting_.push_back(std::move(waiting));
      work_.notify_one();
      return;
    }
  }
  finish(std::move(waiting), answer);
}

void Authenticator::run() {
  pthread_setname_np(pthread_self(), "logins");
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (ending_) return;
    Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    const LoginAttempt& attempt = next.attempt;
    // Attempts that were sent all at once wait here; those behind the third wrong one come too soon
    // like all others.
    const Duration wait = throttle_.wait(attempt.user, attempt.peer, steady_now());
    lock.unlock();
    const LoginResult result =
        wait > Duration{} ? refused(LoginRefused::Why::kTooSoon, wait) : verdict(attempt);
    lock.lock();
    if (result) throttle_.succeeded(attempt.user, attempt.peer);
    if (!result && result.error().why == LoginRefused::Why::kWrong)
      throttle_.failed(attempt.user, attempt.peer, steady_now());
    lock.unlock();
    finish(std::move(next), result);
    lock.lock();
    // A store that does not answer costs its time once, not once for each who waits.
    if (!result && result.error().why == LoginRefused::Why::kUnavailable) turn_away(lock);
  }
}

void Authenticator::turn_away(std::unique_lock<std::mutex>& lock) {
  auto left = std::exchange(waiting_, {});
  lock.unlock();
  for (Waiting& waiting : left)
    finish(std::move(waiting), refused(LoginRefused::Why::kUnavailable));
  lock.lock();
}

LoginResult Authenticator::verdict(const LoginAttempt& attempt) {
  try {
    if (!connection_) connection_ = open_store(address_, IfMissing::kFail);
    if (const auto role = UserTable(*connection_).verify(attempt.user, attempt.password))
      return *role;
    return refused(LoginRefused::Why::kWrong);
  } catch (const StoreError& error) {
    connection_.reset();
    log_counted(LogLevel::kError, "logins", "logins without the store", error.what());
    return refused(LoginRefused::Why::kUnavailable);
  }
}

void Authenticator::finish(Waiting waiting, const LoginResult& result) {
  wipe(waiting.attempt.password);
  const std::string who =
      shown(waiting.attempt.user) +
      (waiting.attempt.peer.empty() ? "" : " from " + shown(waiting.attempt.peer));
  audit_.append({.who = who,
                 .what = "login",
                 .result = result ? "done" : "refused: " + to_text(result.error())});
  waiting.done(result);
}

}  // namespace fieldcast

// Checks logins: one attempt after the other on a thread of its own, since a password takes 0.1 s
// and 64 MiB to check.
#pragma once

#include <memory>
#include <mutex>

#include "bridge/base/worker.hpp"
#include "bridge/store/audit.hpp"
#include "bridge/store/sql.hpp"
#include "bridge/store/users.hpp"
#include "core/access/login_throttle.hpp"

namespace fieldcast {

class Authenticator final : public Logins {
 public:
  // The audit must outlive it. The store need not be there yet.
  Authenticator(StoreAddress address, Audit& audit);
  ~Authenticator() override;  // who still waits gets kUnavailable
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  void authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) override;

 private:
  struct Waiting {
    LoginAttempt attempt;
    std::function<void(LoginResult)> done;
  };
  void run(BoundedQueue<Waiting>& queue);
  void handle(Waiting next, BoundedQueue<Waiting>& queue);
  [[nodiscard]] Duration throttled(const LoginAttempt& attempt);
  void count(const LoginAttempt& attempt, const LoginResult& result);
  [[nodiscard]] LoginResult verdict(const LoginAttempt& attempt);
  void refuse_all(BoundedQueue<Waiting>& queue);  // all who wait
  void finish(Waiting waiting, const LoginResult& result);

  const StoreAddress address_;
  Audit& audit_;
  std::unique_ptr<SqlConnection> connection_;  // on the thread; null: not open
  std::mutex mutex_;                           // guards throttle_
  LoginThrottle throttle_;
  Worker<Waiting> worker_;  // last: it uses what is above
};

}  // namespace fieldcast

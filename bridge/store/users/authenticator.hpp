// Checks logins one after the other on its own thread: a password needs 0.1 s and 64 MiB.
#pragma once

#include <memory>
#include <mutex>

#include "bridge/base/worker.hpp"
#include "bridge/store/records/audit.hpp"
#include "bridge/store/sql/sql.hpp"
#include "bridge/store/users/users.hpp"
#include "core/access/login.hpp"

namespace fieldcast {

class Authenticator final : public Logins {
 public:
  // The audit must outlive this object. The store need not exist yet.
  Authenticator(StoreAddress address, Audit& audit);
  ~Authenticator() override;  // waiting attempts get kUnavailable
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
  void refuse_all(BoundedQueue<Waiting>& queue);
  void finish(Waiting waiting, const LoginResult& result);

  const StoreAddress address_;
  Audit& audit_;
  std::unique_ptr<SqlConnection> connection_;  // used by the thread; null: not open
  std::mutex mutex_;                           // guards throttle_
  LoginThrottle throttle_;
  Worker<Waiting> worker_;  // last: it uses the members above
};

}  // namespace fieldcast

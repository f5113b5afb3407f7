// Logins of users: checks whether a user with this password may log in.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/base/worker.hpp"
#include "bridge/log/log_lines.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"
#include "bridge/store/users/user_table.hpp"
#include "core/access/login.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct LoginAttempt {
  std::string user;
  Secret password;
  // The peer's address without the port. Attempts are throttled by user and by peer.
  std::string peer;
  bool certified = false;  // by a verified certificate; there is no password to check
};

struct LoginRefused {
  enum class Why : std::uint8_t {
    kWrong,        // unknown user or wrong password: same response after the same time
    kUnknown,      // the user of a certificate is not in the store
    kTooSoon,      // after wrong passwords: not checked before `wait` has passed
    kBusy,         // too many other logins are waiting
    kUnavailable,  // the store is not available, or there is none
  };
  Why why = Why::kUnavailable;
  Duration wait{};  // with kTooSoon
};
// One human-readable line, also for the audit; contains no secret.
[[nodiscard]] std::string to_text(const LoginRefused& refused);

using LoginResult = tl::expected<User, LoginRefused>;

class Logins {
 public:
  static constexpr std::size_t kMaxWaiting = 16;       // attempts; more are refused as busy
  static constexpr std::size_t kMaxUserBytes = 64;     // of a name
  static constexpr std::size_t kMinPasswordBytes = 8;  // of a new one
  static constexpr std::size_t kMaxPasswordBytes = 1024;

  virtual ~Logins() = default;
  // Any thread; never blocks. `done` is called exactly once within 30 s: immediately, or on a
  // thread of the logins, where it must only post. Every attempt is audited; of attempts from one
  // peer that are refused without a check, the first since the last check or since 10 min.
  virtual void authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) = 0;
};

// Checks logins one after the other on its own thread: a password needs 0.1 s and 64 MiB.
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
  // An attempt that was refused without a check: it cost its sender nothing.
  void refuse(Waiting waiting, LoginRefused::Why why, Duration wait = {});
  [[nodiscard]] LoginResult verdict(const LoginAttempt& attempt);
  void refuse_all(BoundedQueue<Waiting>& queue);
  void finish(Waiting waiting, const LoginResult& result);

  const StoreAddress address_;
  Audit& audit_;
  std::unique_ptr<SqlConnection> connection_;  // used by the thread; null: not open
  std::mutex mutex_;                           // guards the two below
  LoginThrottle throttle_;
  RepeatFilter unchecked_;  // by address_group() of the peer
  Worker<Waiting> worker_;  // last: it uses the members above
};

// Argon2id of libsodium: hashes a password for the store, and verifies a password against a hash.

// "$argon2id$v=19$m=65536,t=2,p=1$..". The text contains the limits, so they can be raised for new
// hashes. Throws StoreError if memory is not sufficient.
[[nodiscard]] std::string hash_password(std::string_view password);
// Also returns false for a hash without password_limits(), without computing it.
[[nodiscard]] bool password_fits(const std::string& hash, std::string_view password);

// Memory and passes needed to verify against this hash. `std::nullopt` if the text is not a hash,
// or if it needs more than sixteen times as much as hash_password(), so another program wrote it.
struct PasswordLimits {
  std::uint64_t kibibytes = 0;
  std::uint64_t passes = 0;
};
[[nodiscard]] std::optional<PasswordLimits> password_limits(std::string_view hash);

}  // namespace fieldcast

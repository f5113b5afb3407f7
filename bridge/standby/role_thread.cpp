#include "bridge/standby/role_thread.hpp"

#include <pthread.h>

#include "bridge/base/clock.hpp"

namespace fieldcast {
namespace {

constexpr std::chrono::milliseconds kLookAgain{20}, kLook{1000};

}  // namespace

void RoleThread::start(std::function<bool()> look) {
  if (thread_.joinable()) return;
  ending_ = false;
  thread_ = std::thread([this, look = std::move(look)] {
    pthread_setname_np(pthread_self(), "roles");
    std::unique_lock lock(mutex_);
    while (!ending_) {
      const std::uint64_t seen = notified_;
      lock.unlock();
      const bool again = look();
      lock.lock();
      const auto woken = [&] { return notified_ != seen || ending_; };
      changed_.wait_for(lock, again ? kLookAgain : kLook, woken);
    }
  });
}

void RoleThread::notify() {
  const std::lock_guard lock(mutex_);
  ++notified_;
  changed_.notify_all();
}

bool RoleThread::wait_until(Instant limit, const std::function<bool()>& reached) {
  for (;;) {
    std::unique_lock lock(mutex_);
    const std::uint64_t seen = notified_;
    lock.unlock();
    if (reached()) return true;
    const Duration left = limit - steady_now();
    if (left <= Duration::zero()) return false;
    lock.lock();
    changed_.wait_for(lock, left, [&] { return notified_ != seen; });
  }
}

void RoleThread::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

}  // namespace fieldcast

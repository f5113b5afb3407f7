#include "bridge/bridge_roles.hpp"

#include <pthread.h>

#include "bridge/base/clock.hpp"

namespace fieldcast {
namespace {

constexpr std::chrono::milliseconds kLookAgain{20};

}  // namespace

bool Standby::hold(const std::string& bus, const Command& command) {
  return commands.hold(bus, {command.requester, command.request_id}, {bus, command},
                       command.expires, steady_now());
}

bool Standby::hold(const AlarmAction& action) {
  return actions.hold(action.alarm.bus, {action.requester, action.request_id}, action,
                      steady_now() + std::chrono::seconds{10}, steady_now());
}

void Standby::answered() {
  if (--in_hand == 0 && handing_over) notify();
}

void Standby::seen_answer(const std::string& requester, std::uint64_t request_id) {
  const bool waits = commands.waits();
  commands.answered({requester, request_id});
  if (waits) notify();
  actions.answered({requester, request_id});
  note_result(requester, request_id);
}

void Standby::note_result(const std::string& requester, std::uint64_t request_id) {
  const std::lock_guard lock(answered_mutex_);
  with_result_.note({requester, request_id}, steady_now());
}

bool Standby::has_result(const std::string& requester, std::uint64_t request_id) {
  const std::lock_guard lock(answered_mutex_);
  return with_result_.lately({requester, request_id}, steady_now());
}

void Standby::start(std::function<bool()> look) {
  if (thread_.joinable()) return;
  ending_ = false;
  thread_ = std::thread([this, look = std::move(look)] { run(look); });
}

void Standby::notify() {
  const std::lock_guard lock(mutex_);
  ++notified_;
  changed_.notify_all();
}

bool Standby::wait_until(Instant limit, const std::function<bool()>& reached) {
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

void Standby::linger(Duration time) {
  (void)wait_until(steady_now() + time, [] { return false; });
}

void Standby::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void Standby::run(const std::function<bool()>& look) {
  pthread_setname_np(pthread_self(), "roles");
  std::unique_lock lock(mutex_);
  while (!ending_) {
    const std::uint64_t seen = notified_;
    lock.unlock();
    const bool again = look();
    lock.lock();
    const auto woken = [&] { return notified_ != seen || ending_; };
    again ? changed_.wait_for(lock, kLookAgain, woken)
          : changed_.wait_for(lock, std::chrono::seconds{1}, woken);
  }
}

}  // namespace fieldcast

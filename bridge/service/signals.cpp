#include "bridge/service/signals.hpp"

#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>

#include "bridge/base/exit_code.hpp"

namespace fieldcast {
namespace {

sigset_t taken_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGUSR1}) sigaddset(&set, signal);
  return set;
}

}  // namespace

Signals::Signals() {
  const sigset_t set = taken_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { take(); });
}

Signals::~Signals() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void Signals::if_stuck(std::function<void()> last_words) {
  const std::lock_guard lock(mutex_);
  last_words_ = std::move(last_words);
}

int Signals::wait(Duration limit) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, limit, [this] { return !taken_.empty(); })) return 0;
  const int signal = taken_.front();
  taken_.pop_front();
  return signal;
}

void Signals::take() {
  pthread_setname_np(pthread_self(), "signals");
  const sigset_t set = taken_signals();
  for (int signal = 0;;) {
    if (sigwait(&set, &signal) != 0) continue;
    std::unique_lock lock(mutex_);
    if (ended_) return;
    if (std::find(taken_.begin(), taken_.end(), signal) == taken_.end()) taken_.push_back(signal);
    changed_.notify_all();
    if (signal != SIGTERM && signal != SIGINT) continue;
    ending_ = true;
    if (changed_.wait_for(lock, kEndLimit, [this] { return ended_; })) return;
    if (last_words_) last_words_();
    std::_Exit(static_cast<int>(ExitCode::kHung));
  }
}

}  // namespace fieldcast

// The signals of a daemon. A thread of its own takes them and does nothing else. The main thread
// does what they ask for, one after the other; while it hangs in a driver or a library, no signal
// is lost. The thread of signals ends the process when a stop takes too long.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "core/base/time.hpp"

namespace fieldcast {

class Signals {
 public:
  // A stop that takes longer is ended. An orderly stop takes less than two seconds, and supervisors
  // kill after ten at the earliest.
  static constexpr Duration kEndLimit = std::chrono::seconds{8};

  // SIGHUP, SIGUSR1, SIGTERM and SIGINT are for wait(). REQUIRES: no other thread runs yet, since
  // signals are blocked in all that follow.
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // What is done, on the thread of signals, when a stop does not end in time, before the process is
  // ended. Replaces the one before.
  void if_stuck(std::function<void()> last_words);

  // SIGTERM or SIGINT has come.
  [[nodiscard]] bool ending() const { return ending_; }

  // The next one; 0 after the limit.
  [[nodiscard]] int wait(Duration limit);

 private:
  void take();

  std::mutex mutex_;
  std::function<void()> last_words_;
  std::condition_variable changed_;
  std::deque<int> taken_;  // each kind once: a second SIGHUP before the first is served is the same
  std::atomic<bool> ending_ = false;
  bool ended_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast

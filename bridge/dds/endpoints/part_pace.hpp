// The rest after each part of a message in several parts: sockets of readers on this machine hold
// only a few. Any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "core/base/time.hpp"

namespace fieldcast {

class PartPace {
 public:
  static constexpr Duration kPace = std::chrono::microseconds{500};

  // Waits for kPace, or until close().
  void rest() {
    std::unique_lock lock(mutex_);
    closed_.wait_for(lock, kPace, [this] { return is_closed_; });
  }
  [[nodiscard]] bool is_closed() {
    const std::lock_guard lock(mutex_);
    return is_closed_;
  }
  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
    }
    closed_.notify_all();
  }

 private:
  std::mutex mutex_;
  bool is_closed_ = false;
  std::condition_variable closed_;
};

}  // namespace fieldcast

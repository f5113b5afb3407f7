// What DDS threads hand to the main thread: a bounded queue. When it is full the oldest entry goes
// and is counted.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>

namespace fieldcast::cli {

template <typename Event>
class Inbox {
 public:
  static constexpr std::size_t kLimit = 65536;
  using Clock = std::chrono::steady_clock;

  // Any thread; never blocks for longer than a move.
  void put(Event event) {
    const std::lock_guard lock(mutex_);
    if (events_.size() == kLimit) {
      events_.pop_front();
      ++lost_;
    }
    events_.push_back(std::move(event));
    arrived_.notify_one();
  }

  // Ends the present wait and every later one at once.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    arrived_.notify_all();
  }

  // Everything that came; waits for something until `deadline`. Empty: the deadline passed, or the
  // inbox is closed.
  [[nodiscard]] std::deque<Event> take(Clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    arrived_.wait_until(lock, deadline, [this] { return closed_ || !events_.empty(); });
    return std::exchange(events_, {});
  }

  [[nodiscard]] bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }
  [[nodiscard]] std::uint64_t lost() const {
    const std::lock_guard lock(mutex_);
    return lost_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Event> events_;
  std::uint64_t lost_ = 0;
  bool closed_ = false;
};

}  // namespace fieldcast::cli

// What threads hand to one thread: a queue with a limit. What happens at the limit is the caller's
// choice by the function with which it puts: refuse, wait, or drop the oldest.
//
// Any thread may put; one thread takes. No call holds the lock for longer than a move.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace fieldcast {

template <typename Item>
class BoundedQueue {
 public:
  using Clock = std::chrono::steady_clock;

  explicit BoundedQueue(std::size_t limit) : limit_(limit) {}
  BoundedQueue(const BoundedQueue&) = delete;
  BoundedQueue& operator=(const BoundedQueue&) = delete;

  // False, and the item stays the caller's, when the queue is full or closed.
  [[nodiscard]] bool try_put(Item& item) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_ || items_.size() >= limit_) return false;
      items_.push_back(std::move(item));
    }
    arrived_.notify_one();
    return true;
  }

  // Waits while the queue is full.
  void put(Item item) {
    {
      std::unique_lock lock(mutex_);
      space_.wait(lock, [this] { return items_.size() < limit_; });
      items_.push_back(std::move(item));
    }
    arrived_.notify_one();
  }

  // Drops and counts the oldest item when the queue is full.
  void put_newest(Item item) {
    {
      const std::lock_guard lock(mutex_);
      if (items_.size() >= limit_) {
        items_.pop_front();
        ++dropped_;
      }
      items_.push_back(std::move(item));
    }
    arrived_.notify_one();
  }

  // The next item; waits for it. Nothing: the queue is closed and empty.
  [[nodiscard]] std::optional<Item> take() {
    std::optional<Item> item;
    {
      std::unique_lock lock(mutex_);
      arrived_.wait(lock, [this] { return closed_ || !items_.empty(); });
      if (items_.empty()) return std::nullopt;
      item.emplace(std::move(items_.front()));
      items_.pop_front();
    }
    space_.notify_one();
    return item;
  }

  // Everything that came; waits for something. Empty: the queue is closed and empty.
  [[nodiscard]] std::deque<Item> take_all() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return all(lock);
  }
  // As above, and empty when the deadline passes.
  [[nodiscard]] std::deque<Item> take_all(Clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    arrived_.wait_until(lock, deadline, [this] { return closed_ || !items_.empty(); });
    return all(lock);
  }
  // What is there now.
  [[nodiscard]] std::deque<Item> take_present() {
    std::unique_lock lock(mutex_);
    return all(lock);
  }

  // For the thread that takes, between two tries of its work: true when the queue was closed in
  // the meantime.
  [[nodiscard]] bool pause(std::chrono::nanoseconds time) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, time, [this] { return closed_; });
  }

  // Nothing waits in take() any more; try_put() refuses. What is in the queue stays there.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    arrived_.notify_all();
  }
  [[nodiscard]] bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }
  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  std::deque<Item> all(std::unique_lock<std::mutex>& lock) {
    std::deque<Item> items = std::exchange(items_, {});
    lock.unlock();
    space_.notify_all();
    return items;
  }

  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_, space_;
  std::deque<Item> items_;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace fieldcast

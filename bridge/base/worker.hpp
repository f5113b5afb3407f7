// Queue with a limit, from any thread to one thread. The put function decides what happens at the
// limit: refuse, wait, or drop the oldest. No call holds the lock for longer than a move.
#pragma once

#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace fieldcast {

template <typename Item>
class BoundedQueue {
 public:
  using Clock = std::chrono::steady_clock;

  explicit BoundedQueue(std::size_t limit) : limit_(limit) {}
  BoundedQueue(const BoundedQueue&) = delete;
  BoundedQueue& operator=(const BoundedQueue&) = delete;

  // Returns false if the queue is full or closed; the item then stays with the caller.
  [[nodiscard]] bool try_put(Item& item) { return try_insert(item, false); }
  // As try_put(), but the item is taken before all present ones.
  [[nodiscard]] bool try_put_first(Item& item) { return try_insert(item, true); }

  void put(Item item) {
    {
      std::unique_lock lock(mutex_);
      space_.wait(lock, [this] { return items_.size() < limit_; });
      items_.push_back(std::move(item));
    }
    arrived_.notify_one();
  }

  // Drops and counts the oldest item if the queue is full.
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

  // Waits for the next item. Returns `std::nullopt` if the queue is closed and empty.
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

  // Waits for at least one item and returns all. Empty if the queue is closed and empty.
  [[nodiscard]] std::deque<Item> take_all() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return all(lock);
  }
  // As above; also empty if the deadline passes.
  [[nodiscard]] std::deque<Item> take_all(Clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    arrived_.wait_until(lock, deadline, [this] { return closed_ || !items_.empty(); });
    return all(lock);
  }
  // Returns the present items without waiting.
  [[nodiscard]] std::deque<Item> take_present() {
    std::unique_lock lock(mutex_);
    return all(lock);
  }

  // Waits between two attempts of the consumer. Returns true if the queue was closed meanwhile.
  [[nodiscard]] bool pause(std::chrono::nanoseconds time) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, time, [this] { return closed_; });
  }

  // Wakes the consumer; afterwards try_put() refuses. Items stay in the queue.
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
  bool try_insert(Item& item, bool first) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_ || items_.size() >= limit_) return false;
      first ? items_.push_front(std::move(item)) : items_.push_back(std::move(item));
    }
    arrived_.notify_one();
    return true;
  }

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

// A named thread with a bounded queue. Close it before anything that the work uses is destroyed.
template <typename Item>
class Worker {
 public:
  // `work` runs once on the thread and must take until the queue is closed. `name`: 15 bytes.
  Worker(std::string name, std::size_t limit, std::function<void(BoundedQueue<Item>&)> work)
      : queue_(limit), thread_([this, name = std::move(name), work = std::move(work)] {
          pthread_setname_np(pthread_self(), name.c_str());
          work(queue_);
        }) {}
  ~Worker() { close(); }

  [[nodiscard]] BoundedQueue<Item>& queue() { return queue_; }

  // Closes the queue and waits for the work to end; may be called twice. One thread.
  void close() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }

 private:
  BoundedQueue<Item> queue_;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast

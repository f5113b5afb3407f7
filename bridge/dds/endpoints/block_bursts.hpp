// Writes the blocks of many busy buses together. Each datagram wakes two threads of every station,
// which costs a station more than a block of 10 samples does. So blocks wait up to kWindow for
// those of other buses if there are many, and a thread of this object writes them in one burst.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "core/base/time.hpp"

namespace fieldcast {

// Decides whether the next block waits: if the blocks of different buses are so close that a burst
// would have some of them. A single fast bus never waits. Pure.
class BurstRule {
 public:
  static constexpr Duration kWindow = std::chrono::milliseconds{10};  // longest wait of a block
  // Changes from one bus to another within kMeasured that make blocks wait: two for each burst.
  static constexpr int kMany = 20;
  static constexpr Duration kMeasured = 10 * kWindow;
  // Buses that promise a shorter refresh must not wait.
  static constexpr Duration kLeastRefresh = 10 * kWindow;

  // Counts a block of `bus`, any address that identifies it, and returns true if it waits.
  [[nodiscard]] bool waits(const void* bus, Instant now) {
    const Duration measured = now - since_;
    if (measured >= kMeasured) {
      many_ = changes_ * kMeasured >= kMany * measured;
      since_ = now;
      changes_ = 0;
    }
    changes_ += bus != last_ ? 1 : 0;
    last_ = bus;
    return many_;
  }

 private:
  Instant since_{};
  int changes_ = 0;
  const void* last_ = nullptr;
  bool many_ = false;
};

// Any thread.
class BlockBursts {
 public:
  // `write` writes all blocks that wait, on the thread of this object.
  explicit BlockBursts(std::function<void()> write);
  ~BlockBursts() { close(); }
  BlockBursts(const BlockBursts&) = delete;
  BlockBursts& operator=(const BlockBursts&) = delete;

  // See BurstRule. If true, the caller keeps the block for `write` and then calls expect().
  [[nodiscard]] bool waits(const void* bus, Instant now);
  // `write` is called within kWindow.
  void expect();
  // From now on no block waits, and `write` is not called. A second call has no effect.
  void close();

 private:
  void run();

  const std::function<void()> write_;
  std::mutex mutex_;  // protects the members below; not held while `write` runs
  BurstRule rule_;
  std::condition_variable changed_;
  bool expected_ = false, idle_ = false, closed_ = false;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast

// How long the first and the last sample of a block take, for samples that carry their block's
// number. Samples are added on one thread at a time; everything else on another.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "tools/bench/figures.hpp"

namespace fieldcast::bench {

class BlockTimes {
 public:
  using Clock = std::chrono::steady_clock;

  struct Figures {  // milliseconds
    std::size_t blocks = 0;
    double first = 0, first_p99 = 0;  // to the first callback of a block: median, 99th percentile
    double last = 0, last_p99 = 0;    // to its last one
  };

  explicit BlockTimes(std::size_t rows) : rows_(rows) {}

  void start() {
    const std::lock_guard guard(lock_);
    counting_ = true;
  }
  // A sample of block `number`, which left at `sent`, has come.
  void add(std::uint64_t number, Clock::time_point sent, Clock::time_point now) {
    const std::lock_guard guard(lock_);
    if (!counting_) return;
    Open& block = open_[number];
    if (block.rows++ == 0) block.first = milliseconds(now - sent);
    if (block.rows < rows_) return;
    first_.push_back(block.first);
    last_.push_back(milliseconds(now - sent));
    open_.erase(number);
  }
  // Of the blocks that came whole since start().
  [[nodiscard]] Figures stop() {
    const std::lock_guard guard(lock_);
    counting_ = false;
    return {first_.size(), quantile(first_, 0.5), quantile(first_, 0.99), quantile(last_, 0.5),
            quantile(last_, 0.99)};
  }

 private:
  struct Open {
    std::size_t rows = 0;
    double first = 0;
  };
  static double milliseconds(Clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
  }

  const std::size_t rows_;  // of each block
  std::mutex lock_;
  bool counting_ = false;
  std::unordered_map<std::uint64_t, Open> open_;  // by number: came in part
  std::vector<double> first_, last_;
};

}  // namespace fieldcast::bench

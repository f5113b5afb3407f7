#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

namespace fieldcast::bench {

// The q-quantile (0..1) of the values; 0 if there are none.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

template <class Number>
void print_figure(const std::string& what, Number value, const char* unit = "",
                  const std::string& goal = {}) {
  std::printf("%-58s %12.4g %-10s %s\n", what.c_str(), static_cast<double>(value), unit,
              goal.c_str());
  std::fflush(stdout);
}

using Clock = std::chrono::steady_clock;
[[nodiscard]] inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Measures the delay of the first and last sample of each block. add() runs on one thread.
class BlockTimes {
 public:
  struct Figures {  // milliseconds
    std::size_t blocks = 0;
    double first = 0, first_p99 = 0;  // delay of a block's first callback: median, 99th percentile
    double last = 0, last_p99 = 0;    // delay of its last callback
  };

  explicit BlockTimes(std::size_t rows) : rows_(rows) {}

  void start() {
    const std::lock_guard guard(lock_);
    counting_ = true;
  }
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
  std::unordered_map<std::uint64_t, Open> open_;  // incomplete blocks by number
  std::vector<double> first_, last_;
};

}  // namespace fieldcast::bench

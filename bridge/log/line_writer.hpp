// Lines for a descriptor that may take none for any length of time: a pipe that nobody reads, a
// terminal that is stopped, a disk that is full. Whoever hands a line in never waits; a thread of
// its own writes.
//
// The queue is bounded: when it is full its oldest lines are dropped, and a remark stands in their
// place that says how many. The thread may hang in write(2) for ever, so nothing ever joins it: it
// shares what it uses with the LineWriter and may outlive it. That is why it is neither a Worker
// (its end joins the thread) nor spdlog's asynchronous logger (the same), and the queue no
// BoundedQueue: its limit is in bytes, and flush() waits until lines are written.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast {

class LineWriter {
 public:
  static constexpr std::size_t kMaxWaiting = std::size_t{1} << 20;  // bytes

  // `remark` is the line that stands for so many lines lost; it is called on the writer's thread.
  // The descriptor is duplicated. Signals are blocked in the thread.
  LineWriter(int fd, std::function<std::string(std::uint64_t lost)> remark);
  ~LineWriter();  // what waits is lost: flush() first
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  // Lines that are not written yet, and all that come, go to this descriptor. Any thread; does not
  // wait for the one before.
  void reopen(int fd);

  // A line with its end. Any thread; never waits for the descriptor.
  void put(std::string line);

  // Waits until every line put before is written or lost; false after the limit.
  [[nodiscard]] bool flush(Duration limit);

  // Lines that were dropped, or that the descriptor refused (a full disk, a closed pipe).
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct State;
  std::shared_ptr<State> state_;  // shared with the thread
};

}  // namespace fieldcast

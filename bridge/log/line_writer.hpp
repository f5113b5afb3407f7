// Writes lines to a descriptor that may block for any time: a pipe without a reader, a stopped
// terminal, a full disk. The caller never waits; a separate thread writes.
//
// The queue is bounded: when it is full, the oldest lines are dropped and replaced by a remark with
// their number. The thread may hang in write(2) forever, so it is never joined: it shares its state
// with the LineWriter and may outlive it. A Worker and spdlog's asynchronous logger join their
// thread, so neither is used. A BoundedQueue does not fit either: this limit is in bytes, and
// flush() waits until lines are written.
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

  // `remark` makes the line that replaces lost lines; it is called on the writer's thread. The
  // descriptor is duplicated. Signals are blocked in the thread.
  LineWriter(int fd, std::function<std::string(std::uint64_t lost)> remark);
  ~LineWriter();  // waiting lines are lost; call flush() before
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  // Unwritten and later lines go to this descriptor. Any thread; does not wait for the old one.
  void reopen(int fd);

  // `line` includes its line end. Any thread; never waits.
  void put(std::string line);

  // Waits until every earlier line is written or lost. Returns false after the limit.
  [[nodiscard]] bool flush(Duration limit);

  // Lines that were dropped or that the descriptor refused (full disk, closed pipe).
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct State;
  std::shared_ptr<State> state_;  // shared with the thread
};

}  // namespace fieldcast

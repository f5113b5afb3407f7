// Ctrl-C of a command that works on without looking: the process ends where it is, with the exit
// code 130. The progress line is wiped, and no file is left half written.
//
// Make one before any thread is started. The end comes on a thread of its own.
#pragma once

#include <condition_variable>
#include <mutex>

#include "core/base/time.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

class EndAtOnce {
 public:
  // `grace`: for a command that looks at interrupt() now and then and ends by itself. It should be
  // a fraction of a second.
  explicit EndAtOnce(Duration grace = Duration::zero());
  ~EndAtOnce();
  EndAtOnce(const EndAtOnce&) = delete;
  EndAtOnce& operator=(const EndAtOnce&) = delete;

  // Locked while something is made that is of no use half: the end waits for it.
  [[nodiscard]] std::mutex& whole() { return whole_; }
  [[nodiscard]] const Interrupt& interrupt() const { return interrupt_; }

 private:
  void end();

  const Duration grace_;
  std::mutex whole_;
  std::condition_variable changed_;
  bool ended_ = false;  // by itself; guarded by whole_
  Interrupt interrupt_;
};

}  // namespace fieldcast::cli

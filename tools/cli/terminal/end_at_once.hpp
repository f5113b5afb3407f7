// Ends the process immediately after Ctrl-C with exit code 130, for commands that do not check for
// signals. Clears the progress line and leaves no incomplete file. Create it before any thread is
// started.
#pragma once

#include <condition_variable>
#include <mutex>

#include "core/base/time.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

class EndAtOnce {
 public:
  // `grace`: time for a command that checks interrupt(); at most a fraction of a second.
  explicit EndAtOnce(Duration grace = Duration::zero());
  ~EndAtOnce();
  EndAtOnce(const EndAtOnce&) = delete;
  EndAtOnce& operator=(const EndAtOnce&) = delete;

  // Lock it while an output is incomplete; the end waits for it.
  [[nodiscard]] std::mutex& whole() { return whole_; }
  [[nodiscard]] const Interrupt& interrupt() const { return interrupt_; }

 private:
  void end();

  const Duration grace_;
  std::mutex whole_;
  std::condition_variable changed_;
  bool ended_ = false;  // the command has ended by itself; guarded by whole_
  Interrupt interrupt_;
};

}  // namespace fieldcast::cli

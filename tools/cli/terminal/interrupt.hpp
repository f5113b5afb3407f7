// The two clocks of a command: monotonic for waits and rates, UTC for ages.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "core/base/time.hpp"

namespace fieldcast::cli {

[[nodiscard]] inline Instant instant_now() {
  return Instant{std::chrono::steady_clock::now().time_since_epoch()};
}

[[nodiscard]] inline UtcTime utc_now() {
  return UtcTime{
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())
          .count()};
}

[[nodiscard]] inline std::chrono::steady_clock::time_point to_steady(Instant at) {
  return std::chrono::steady_clock::time_point{at.time_since_epoch()};
}

// Handles Ctrl-C and SIGTERM as an event, so that every command ends normally. Create it in main
// before any thread is started: only its own thread receives the signals.
class Interrupt {
 public:
  // Time limit after a signal; then, or at a second signal, the process ends immediately.
  static constexpr std::chrono::seconds kEndLimit{8};

  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] bool raised() const { return raised_; }  // thread-safe

  // Calls `wake` once on this object's thread at a signal, or immediately if one has arrived.
  // Replaces the previous function; an empty one removes it.
  void on_raise(std::function<void()> wake);

 private:
  void wait_for_signals();

  std::atomic<bool> raised_ = false;
  std::atomic<bool> ending_ = false;
  std::mutex mutex_;  // guards wake_
  std::function<void()> wake_;
  std::thread thread_;
};

// Ends the process immediately after Ctrl-C with exit code 130, for commands that do not check for
// signals. Clears the progress line and leaves no incomplete file. Create it before any thread is
// started.
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

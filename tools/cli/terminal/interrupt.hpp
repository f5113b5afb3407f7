// Handles Ctrl-C and SIGTERM as an event, so that every command ends normally. Create it in main
// before any thread is started: only its own thread receives the signals.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>

namespace fieldcast::cli {

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

}  // namespace fieldcast::cli

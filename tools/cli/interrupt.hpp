// Ctrl-C and termination as an ordinary event, so that every command ends through its own last
// line.
//
// Make one in main before any thread is started: the signals are blocked there and taken by this
// object's thread alone.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>

namespace fieldcast::cli {

class Interrupt {
 public:
  // Of a command that was asked to end; then, or with a second signal, the process ends at once.
  static constexpr std::chrono::seconds kEndLimit{8};

  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] bool raised() const { return raised_; }  // any thread

  // Called once, on this object's thread, when a signal comes; at once if it came already. Replaces
  // the one before; empty: none.
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

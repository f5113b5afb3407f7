// Signals of a daemon, received on a separate thread and handled on the main thread. None is lost
// while the main thread hangs. The signal thread ends the process if a stop takes too long.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "bridge/base/exit_code.hpp"
#include "core/base/time.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

// Time for the log to be written before the process ends.
inline constexpr Duration kLastWords = std::chrono::milliseconds{300};

// main() of a daemon: protects its memory, and logs what `run` throws. Returns the exit code.
[[nodiscard]] int daemon_main(const char* name, const std::function<ExitCode()>& run);

class Signals {
 public:
  // Limit of a stop; then the process is ended. An orderly stop needs less than two seconds, and
  // supervisors kill after ten at the earliest.
  static constexpr Duration kEndLimit = std::chrono::seconds{8};

  // A result of wait() that is no signal: see on_removed(). A signal of its own for this would also
  // come from others; for example, runtimes of containers pass SIGURG on.
  static constexpr int kRemoved = -1;

  // wait() returns SIGHUP, SIGUSR1, SIGTERM, SIGINT and kRemoved. REQUIRES: no other thread runs
  // yet, because only threads created later inherit the signal mask.
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // Action of the signal thread before it ends the process, for the life of the returned object.
  [[nodiscard]] std::shared_ptr<void> if_stuck(std::function<void()> last_words);

  [[nodiscard]] bool ending() const { return ending_; }

  // Returns the next signal, or 0 after the limit.
  [[nodiscard]] int wait(Duration limit);

 private:
  void take();
  void put(int signal);  // mutex_ is locked

  std::mutex mutex_;
  std::function<void()> last_words_;
  std::condition_variable changed_;
  // Each kind once: a second SIGHUP before the first is handled adds nothing.
  std::deque<int> taken_;
  std::atomic<bool> ending_ = false;
  bool ended_ = false;
  std::thread thread_;  // last: it uses the members above
};

// Logs faults of this program's DDS Security identity, daily and when it expires. Main thread.

// Returns true if a day has passed, the clock was set back, or a certificate with this end has
// expired since `last`. Pure.
[[nodiscard]] bool is_look_due(std::optional<UtcTime> not_after, UtcTime last, UtcTime now);

// Log of a program without a reload that ends after Signals::kRemoved.
inline constexpr const char* kEndsRemoved =
    "was suspended, and the other members have removed it: it ends, and its service starts it "
    "again";

class IdentityWatch {
 public:
  explicit IdentityWatch(bool is_bridge) : is_bridge_(is_bridge) {}

  // The program has joined or rejoined with the present contents of its folder.
  void joined(const DdsSpec& spec, UtcTime now);
  // No effect without security, or before is_look_due().
  void look(UtcTime now);

 private:
  const bool is_bridge_;
  std::optional<std::string> folder_;
  std::optional<UtcTime> not_after_;  // of the certificate in use
  UtcTime last_;
};

}  // namespace fieldcast

// Limits log lines that outsiders can cause: the first kLines of a kind in each kPeriod. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

struct LineVerdict {
  bool log = false;
  std::uint64_t suppressed = 0;  // lines of this kind that were not logged before
};
struct LineSummary {
  std::string key;
  std::uint64_t suppressed = 0;
};

class LineBudget {
 public:
  static constexpr unsigned kLines = 10;
  static constexpr Duration kPeriod = std::chrono::minutes{10};
  static constexpr std::size_t kMaxKinds = 64;  // further kinds share one budget

  [[nodiscard]] LineVerdict occurred(std::string_view kind, Instant now);
  // Returns the kinds with suppressed lines whose period has ended; each once.
  [[nodiscard]] std::vector<LineSummary> summaries(Instant now);

 private:
  struct Entry {
    Instant begun;
    unsigned lines = 0;
    std::uint64_t suppressed = 0;
  };
  std::map<std::string, Entry, std::less<>> entries_;
};

// Decides which occurrences of a fault are logged: the first of a key; later ones are counted, and
// summarized after kSummary or when the fault ends. Pure; one owner, one thread.
class RepeatFilter {
 public:
  static constexpr Duration kSummary = std::chrono::minutes{10};
  // A new key beyond it replaces the key that was quiet longest.
  static constexpr std::size_t kMaxKeys = 4096;

  [[nodiscard]] LineVerdict occurred(const std::string& key, Instant now);
  // The fault has ended. `log` is true if it had occurred. Its next occurrence is logged again.
  [[nodiscard]] LineVerdict recovered(const std::string& key);
  // Keys with suppressed occurrences whose last line is kSummary old, each once. Call periodically.
  [[nodiscard]] std::vector<LineSummary> summaries(Instant now);

 private:
  struct Entry {
    Instant last_line;
    Instant last_seen;
    std::uint64_t suppressed = 0;
  };
  void make_room();
  std::unordered_map<std::string, Entry> entries_;
};

// Writes lines to a descriptor that may block for any time: a pipe without a reader, a full disk.
// The caller never waits. The queue is bounded: the oldest lines are dropped and replaced by a
// remark with their number. The thread may hang in write(2), so it is never joined and may outlive
// the LineWriter; a Worker and spdlog's asynchronous logger join theirs. A BoundedQueue does not
// fit: the limit is in bytes, and flush() waits until lines are written.
class LineWriter {
 public:
  static constexpr std::size_t kMaxWaiting = std::size_t{1} << 20;  // bytes

  // `remark` makes the line that replaces lost ones, on the writer's thread. Duplicates `fd`.
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

// "Logged once, then counted": decides which occurrences of a fault become a line of the log. Pure;
// one owner, one thread.
//
// The first occurrence of a key is worth a line. Later ones are counted, and summarised when
// kSummary has passed since the last line about the key, or when the fault ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

class RepeatFilter {
 public:
  static constexpr Duration kSummary = std::chrono::minutes{10};
  // A key beyond that replaces the key that was quiet for longest.
  static constexpr std::size_t kMaxKeys = 4096;

  struct Verdict {
    bool log = false;              // worth a line
    std::uint64_t suppressed = 0;  // occurrences since the last line that got none
  };
  // The fault `key` occurred.
  [[nodiscard]] Verdict occurred(const std::string& key, Instant now);
  // The fault `key` is over: log is true if it had occurred, and its next occurrence is a first one
  // again.
  [[nodiscard]] Verdict recovered(const std::string& key);

  struct Summary {
    std::string key;
    std::uint64_t suppressed = 0;
  };
  // Keys with uncounted occurrences whose last line is kSummary old. Asked now and then; each is
  // reported once.
  [[nodiscard]] std::vector<Summary> summaries(Instant now);

 private:
  struct Entry {
    Instant last_line;
    Instant last_seen;
    std::uint64_t suppressed = 0;
  };
  void make_room();
  std::unordered_map<std::string, Entry> entries_;
};

}  // namespace fieldcast

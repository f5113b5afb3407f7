// Decides which occurrences of a fault are logged. Pure; one owner, one thread.
//
// The first occurrence of a key is logged. Later ones are counted, and summarized when kSummary has
// passed since the last line about the key, or when the fault ends.
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
  // A new key beyond it replaces the key that was quiet longest.
  static constexpr std::size_t kMaxKeys = 4096;

  struct Verdict {
    bool log = false;
    std::uint64_t suppressed = 0;  // occurrences since the last line that were not logged
  };
  [[nodiscard]] Verdict occurred(const std::string& key, Instant now);
  // The fault has ended. `log` is true if it had occurred. Its next occurrence is logged again.
  [[nodiscard]] Verdict recovered(const std::string& key);

  struct Summary {
    std::string key;
    std::uint64_t suppressed = 0;
  };
  // Keys with suppressed occurrences whose last line is kSummary old, each once. Call periodically.
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

// Limits the log lines of kinds that outsiders can cause without limit. In each kPeriod, the first
// kLines of a kind are logged; more are only counted. Pure; one owner, one thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

class LineBudget {
 public:
  static constexpr unsigned kLines = 10;
  static constexpr Duration kPeriod = std::chrono::minutes{10};
  static constexpr std::size_t kMaxKinds = 64;  // further kinds share one budget

  struct Verdict {
    bool log = false;
    std::uint64_t suppressed = 0;  // lines of this kind that were not logged in the previous period
  };
  [[nodiscard]] Verdict occurred(std::string_view kind, Instant now);

  struct Summary {
    std::string kind;
    std::uint64_t suppressed = 0;
  };
  // Returns the kinds with suppressed lines whose period has ended; each once.
  [[nodiscard]] std::vector<Summary> summaries(Instant now);

 private:
  struct Entry {
    Instant begun;
    unsigned lines = 0;
    std::uint64_t suppressed = 0;
  };
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace fieldcast

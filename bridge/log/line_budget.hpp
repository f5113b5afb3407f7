// How many lines of one kind a log takes: for lines that outsiders can cause as often as they like.
// The first kLines of a kind in kPeriod are worth a line each; what comes beyond is counted. Pure;
// one owner, one thread.
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
  static constexpr std::size_t kMaxKinds = 64;  // those beyond share one budget

  struct Verdict {
    bool log = false;              // worth a line
    std::uint64_t suppressed = 0;  // of the kind that got no line in the period before
  };
  [[nodiscard]] Verdict occurred(std::string_view kind, Instant now);

  struct Summary {
    std::string kind;
    std::uint64_t suppressed = 0;
  };
  // Kinds whose period has ended with lines that were only counted; each is reported once.
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

#include "bridge/log/line_budget.hpp"

#include <utility>

namespace fieldcast {

LineBudget::Verdict LineBudget::occurred(std::string_view kind, Instant now) {
  auto found = entries_.find(kind);
  if (found == entries_.end()) {
    if (entries_.size() >= kMaxKinds) kind = "others";
    found = entries_.try_emplace(std::string(kind), Entry{now}).first;
  }
  Entry& entry = found->second;
  std::uint64_t suppressed = 0;
  if (now - entry.begun >= kPeriod) {
    suppressed = entry.suppressed;
    entry = {now};
  }
  if (entry.lines == kLines) {
    ++entry.suppressed;
    return {};
  }
  ++entry.lines;
  return {true, suppressed};
}

std::vector<LineBudget::Summary> LineBudget::summaries(Instant now) {
  std::vector<Summary> due;
  for (auto& [kind, entry] : entries_) {
    if (entry.suppressed == 0 || now - entry.begun < kPeriod) continue;
    due.push_back({kind, entry.suppressed});
    entry = {now};
  }
  return due;
}

}  // namespace fieldcast

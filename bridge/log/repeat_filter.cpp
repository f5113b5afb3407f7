#include "bridge/log/repeat_filter.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

RepeatFilter::Verdict RepeatFilter::occurred(const std::string& key, Instant now) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) {
    make_room();
    entries_.emplace(key, Entry{now, now});
    return {true, 0};
  }
  Entry& entry = found->second;
  entry.last_seen = now;
  if (now - entry.last_line < kSummary) {
    ++entry.suppressed;
    return {};
  }
  entry.last_line = now;
  return {true, std::exchange(entry.suppressed, 0)};
}

RepeatFilter::Verdict RepeatFilter::recovered(const std::string& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return {};
  const Verdict verdict{true, found->second.suppressed};
  entries_.erase(found);
  return verdict;
}

std::vector<RepeatFilter::Summary> RepeatFilter::summaries(Instant now) {
  std::vector<Summary> due;
  for (auto& [key, entry] : entries_) {
    if (entry.suppressed == 0 || now - entry.last_line < kSummary) continue;
    due.push_back({key, std::exchange(entry.suppressed, 0)});
    entry.last_line = now;
  }
  std::sort(due.begin(), due.end(),
            [](const Summary& a, const Summary& b) { return a.key < b.key; });
  return due;
}

void RepeatFilter::make_room() {
  if (entries_.size() < kMaxKeys) return;
  entries_.erase(std::min_element(
      entries_.begin(), entries_.end(),
      [](const auto& a, const auto& b) { return a.second.last_seen < b.second.last_seen; }));
}

}  // namespace fieldcast

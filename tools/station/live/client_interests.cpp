#include "tools/station/live/client_interests.hpp"

namespace fieldcast::web {

bool ClientInterests::add(const std::string& pattern, Duration refresh) {
  if (wished_.size() >= kMaxPatterns && !wished_.contains(pattern)) return false;
  std::multiset<Duration>& wishes = wished_[pattern];
  const bool shorter = wishes.empty() || refresh < *wishes.begin();
  wishes.insert(refresh);
  if (shorter) declare_(pattern, refresh);
  return true;
}

void ClientInterests::remove(const std::string& pattern, Duration refresh) {
  const auto found = wished_.find(pattern);
  std::multiset<Duration>& wishes = found->second;
  const Duration before = *wishes.begin();
  wishes.erase(wishes.find(refresh));
  if (wishes.empty()) {
    wished_.erase(found);
    declare_(pattern, Duration{});
  } else if (*wishes.begin() != before) {
    declare_(pattern, *wishes.begin());
  }
}

}  // namespace fieldcast::web

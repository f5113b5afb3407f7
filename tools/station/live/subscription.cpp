#include "tools/station/live/subscription.hpp"

#include <algorithm>

namespace fieldcast::web {

bool LiveSubscription::add(const Pattern& pattern) {
  const bool had_everything = key_ == kEverything;
  const bool is_new = patterns_.emplace(pattern.text(), pattern).second;
  make_key();
  return is_new && !had_everything;
}

bool LiveSubscription::remove(const Pattern& pattern) {
  const bool found = patterns_.erase(pattern.text()) != 0;
  make_key();
  return found;
}

bool LiveSubscription::matches(const StationChannel& channel) const {
  if (key_ == kEverything) return true;
  return std::any_of(patterns_.begin(), patterns_.end(), [&](const auto& entry) {
    return entry.second.matches(channel.bus, channel.device, channel.channel);
  });
}

void LiveSubscription::make_key() {
  if (patterns_.contains(kEverything)) {
    key_ = kEverything;
    return;
  }
  key_.clear();
  for (const auto& [text, pattern] : patterns_) key_ += text + '\n';
}

}  // namespace fieldcast::web

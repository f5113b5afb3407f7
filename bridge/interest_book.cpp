#include "bridge/interest_book.hpp"

#include <algorithm>

namespace fieldcast {

tl::expected<void, std::string> InterestBook::note(const std::string& station, const std::string& pattern,
                                                   std::optional<Duration> refresh) {
  const auto parsed = Pattern::parse(pattern);
  if (!parsed) return tl::make_unexpected("station " + station + ": " + parsed.error());
  const std::string key = parsed->text();
  auto found = patterns_.find(key);

  if (!refresh) {
    if (found == patterns_.end()) return {};
    count_ -= found->second.stations.erase(station);
    if (found->second.stations.empty()) patterns_.erase(found);
    return {};
  }
  if (*refresh <= Duration::zero()) return tl::make_unexpected("station " + station + ": a refresh must be longer than nothing");
  const bool known = found != patterns_.end() && found->second.stations.contains(station);
  if (!known && (count_ == kMaxWishes || (found == patterns_.end() && patterns_.size() == kMaxPatterns))) {
    return tl::make_unexpected("station " + station + ": its interest is refused, too many are held");
  }
  if (found == patterns_.end()) found = patterns_.emplace(key, Wishes{*parsed, {}}).first;
  count_ += known ? 0 : 1;
  found->second.stations[station] = *refresh;
  return {};
}

std::map<ChannelIndex, Duration> InterestBook::wishes(const BusSpec& bus) const {
  std::map<ChannelIndex, Duration> shortest;
  for (const auto& [text, wishes] : patterns_) {
    if (!wishes.pattern.matches(bus.name)) continue;
    const Duration wish = std::min_element(wishes.stations.begin(), wishes.stations.end(), [](const auto& a, const auto& b) {
                            return a.second < b.second;
                          })->second;
    ChannelIndex index = 0;
    for (const DeviceSpec& device : bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        if (wishes.pattern.matches(bus.name, device.name, channel.name)) {
          const auto [entry, added] = shortest.try_emplace(index, wish);
          if (!added) entry->second = std::min(entry->second, wish);
        }
        ++index;
      }
    }
  }
  return shortest;
}

std::vector<InterestChanged> changes(const std::map<ChannelIndex, Duration>& before,
                                     const std::map<ChannelIndex, Duration>& after) {
  std::vector<InterestChanged> all;
  for (const auto& [channel, refresh] : after) {
    const auto old = before.find(channel);
    if (old == before.end() || old->second != refresh) all.push_back({channel, refresh});
  }
  for (const auto& [channel, refresh] : before) {
    if (!after.contains(channel)) all.push_back({channel, std::nullopt});
  }
  return all;
}

}  // namespace fieldcast

#include "bridge/interest/interest_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast {

tl::expected<void, std::string> InterestTable::note(const std::string& station,
                                                    const std::string& pattern,
                                                    std::optional<Duration> refresh) {
  const auto parsed = Pattern::parse(pattern);
  if (!parsed) return tl::make_unexpected(fmt::format("station {}: {}", station, parsed.error()));
  const std::string key = parsed->text();
  auto found = patterns_.find(key);

  if (!refresh) {
    if (found == patterns_.end()) return {};
    count_ -= found->second.stations.erase(station);
    if (found->second.stations.empty()) patterns_.erase(found);
    return {};
  }
  if (*refresh < kShortest || *refresh > kLongest) {
    return tl::make_unexpected(
        fmt::format("station {}: an interest in {} every {} is refused: a refresh is {} to {}",
                    station, key, to_text(*refresh), to_text(kShortest), to_text(kLongest)));
  }
  const bool known = found != patterns_.end() && found->second.stations.contains(station);
  if (!known &&
      (count_ == kMaxInterests || (found == patterns_.end() && patterns_.size() == kMaxPatterns))) {
    return tl::make_unexpected(
        fmt::format("station {}: its interest in {} is refused: {} interests of {} patterns are "
                    "held, at most {} of {}",
                    station, key, count_, patterns_.size(), kMaxInterests, kMaxPatterns));
  }
  if (found == patterns_.end()) found = patterns_.emplace(key, Interested{*parsed, {}}).first;
  count_ += known ? 0 : 1;
  if (!known && new_.size() < kMaxNew) new_.push_back({station, *parsed});
  found->second.stations[station] = *refresh;
  return {};
}

std::map<ChannelIndex, Duration> InterestTable::interests(const BusSpec& bus) const {
  struct Wanted {
    const Pattern* pattern;
    Duration refresh;
  };
  std::vector<Wanted> wanted;
  for (const auto& [text, interested] : patterns_) {
    if (!interested.pattern.matches(bus.name)) continue;
    const auto shortest = std::ranges::min_element(
        interested.stations, {}, [](const auto& station) { return station.second; });
    wanted.push_back({&interested.pattern, shortest->second});
  }
  std::ranges::sort(wanted, {}, &Wanted::refresh);
  std::map<ChannelIndex, Duration> all;
  if (wanted.empty()) return all;
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      const ChannelIndex at = index++;
      if (!channel.on_interest) continue;
      const auto first = std::ranges::find_if(wanted, [&](const Wanted& one) {
        return one.pattern->matches(bus.name, device.name, channel.name);
      });
      if (first != wanted.end()) all.emplace_hint(all.end(), at, first->refresh);
    }
  }
  return all;
}

InterestTable::Reach InterestTable::reach(const Pattern& pattern, const BusSpec& bus) {
  Reach reach;
  if (!pattern.matches(bus.name)) return reach;
  for (const DeviceSpec& device : bus.devices) {
    if (!pattern.matches(bus.name, device.name)) continue;
    for (const ChannelSpec& channel : device.channels) {
      if (!pattern.matches(bus.name, device.name, channel.name)) continue;
      ++reach.channels;
      reach.on_interest += channel.on_interest ? 1 : 0;
    }
  }
  return reach;
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

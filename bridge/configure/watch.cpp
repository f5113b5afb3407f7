#include "bridge/configure/watch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

namespace fieldcast::configure {

namespace {

constexpr std::size_t kMostNamed = 5;  // channels in a reason

bool is_bad(Quality quality) { return quality != Quality::kGood && quality != Quality::kUncertain; }

}  // namespace

std::string_view to_text(Watch::State state) {
  return state == Watch::State::kReloading ? "reloading" : "watching";
}

std::vector<std::string> good_channels(const ChannelQualities& now) {
  std::vector<std::string> good;
  for (const auto& [channel, quality] : now) {
    if (quality == Quality::kGood) good.push_back(channel);
  }
  return good;
}

std::vector<std::string> worse_channels(const Watch& watch, const ChannelQualities& now) {
  std::vector<std::string> worse;
  for (const std::string& channel : watch.good) {
    const auto found = now.find(channel);
    if (found != now.end() && is_bad(found->second))
      worse.push_back(fmt::format("{} {}", channel, fieldcast::to_text(found->second)));
  }
  return worse;
}

WatchStep reloaded(Watch& watch, const std::string& refusal, Instant now) {
  if (watch.state != Watch::State::kReloading) return {};
  if (!refusal.empty()) return {WatchEnd::kRollBack, "the bridge did not load it: " + refusal};
  watch.state = Watch::State::kWatching;
  watch.until = now + Watch::kLength;
  return {};
}

WatchStep looked(const Watch& watch, const ChannelQualities& qualities, Instant now) {
  if (now < watch.until) return {};
  if (watch.state == Watch::State::kReloading)
    return {WatchEnd::kRollBack, "the bridge did not load it in time"};
  const std::vector<std::string> worse = worse_channels(watch, qualities);
  if (worse.empty()) return {WatchEnd::kKeep, "no channel that was good is bad"};
  const std::span named(worse.data(), std::min(worse.size(), kMostNamed));
  return {WatchEnd::kRollBack,
          fmt::format("nobody confirmed it, and of the channels that were good {} {} bad now: {}{}",
                      worse.size(), worse.size() == 1 ? "is" : "are", fmt::join(named, ", "),
                      worse.size() > named.size() ? ", .." : "")};
}

WatchStep restarted(Watch& watch, bool is_valid, Instant now) {
  if (!is_valid) return {WatchEnd::kRollBack, "the bridge restarted and cannot load it"};
  if (++watch.restarts > Watch::kMostRestarts)
    return {WatchEnd::kRollBack, "the bridge restarted repeatedly with it"};
  watch.state = Watch::State::kWatching;
  watch.until = now + Watch::kLength;
  return {};
}

}  // namespace fieldcast::configure

#include "bridge/interest/interest_registry.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>

#include "bridge/base/clock.hpp"

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

std::vector<InterestTable::Match> InterestTable::matches_of(const BusSpec& bus) const {
  std::vector<Match> matches;
  for (const auto& [text, interested] : patterns_) {
    if (!interested.pattern.matches(bus.name)) continue;
    const auto shortest = std::ranges::min_element(
        interested.stations, {}, [](const auto& station) { return station.second; });
    matches.push_back({&interested.pattern, shortest->second});
  }
  std::ranges::sort(matches, {}, &Match::refresh);
  return matches;
}

InterestTable::InputRefreshes InterestTable::input_refreshes(
    const std::vector<const BusSpec*>& buses) const {
  std::map<ChannelPath, const Calculation*> calculations;
  std::vector<std::pair<ChannelPath, Duration>> pending;
  for (const BusSpec* bus : buses) {
    const std::vector<Match> matches = matches_of(*bus);
    for (const DeviceSpec& device : bus->devices) {
      for (const ChannelSpec& channel : device.channels) {
        if (!channel.calculation) continue;
        const ChannelPath path{bus->name, device.name, channel.name};
        calculations.emplace(path, channel.calculation.value.get());
        const auto first = std::ranges::find_if(matches, [&](const Match& one) {
          return one.pattern->matches(path.bus, path.device, path.channel);
        });
        if (first != matches.end()) pending.emplace_back(path, first->refresh);
      }
    }
  }
  InputRefreshes all;
  while (!pending.empty()) {
    const auto [path, refresh] = std::move(pending.back());
    pending.pop_back();
    const auto calculation = calculations.find(path);
    if (calculation == calculations.end()) continue;
    for (const ChannelPath& input : calculation->second->inputs) {
      const auto [at, is_new] = all.try_emplace(input, refresh);
      if (!is_new && at->second <= refresh) continue;
      at->second = refresh;
      pending.emplace_back(input, refresh);
    }
  }
  return all;
}

std::map<ChannelIndex, Duration> InterestTable::interests(const BusSpec& bus,
                                                          const InputRefreshes& inputs) const {
  const std::vector<Match> wanted = matches_of(bus);
  std::map<ChannelIndex, Duration> all;
  if (wanted.empty() && inputs.empty()) return all;
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      const ChannelIndex at = index++;
      if (!channel.on_interest) continue;
      const auto first = std::ranges::find_if(wanted, [&](const Match& one) {
        return one.pattern->matches(bus.name, device.name, channel.name);
      });
      const auto input = inputs.find({bus.name, device.name, channel.name});
      if (first != wanted.end()) all.emplace_hint(all.end(), at, first->refresh);
      if (input == inputs.end()) continue;
      const auto known = all.try_emplace(all.end(), at, input->second);
      known->second = std::min(known->second, input->second);
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
      reach.on_interest += channel.on_interest || channel.calculation ? 1 : 0;
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

InterestRegistry::InterestRegistry(std::function<void(std::string)> remark)
    : remark_(std::move(remark)), thread_([this] { run(); }) {}

InterestRegistry::~InterestRegistry() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void InterestRegistry::add(const BusSpec& bus, std::shared_ptr<BusRunner> runner) {
  auto made = std::make_shared<Bus>();
  made->spec = bus;
  made->runner = std::move(runner);
  {
    const std::lock_guard lock(mutex_);
    buses_[bus.name] = std::move(made);
    dirty_ = true;
  }
  changed_.notify_one();
}

void InterestRegistry::remove(const std::string& bus) {
  std::shared_ptr<Bus> removed;
  {
    const std::lock_guard lock(mutex_);
    const auto found = buses_.find(bus);
    if (found == buses_.end()) return;
    removed = std::move(found->second);
    buses_.erase(found);
  }
  const std::lock_guard lock(removed->mutex);
  removed->runner.reset();
}

void InterestRegistry::all_added() {
  {
    const std::lock_guard lock(mutex_);
    dirty_ = all_added_ = true;
  }
  changed_.notify_one();
}

void InterestRegistry::forget() {
  {
    const std::lock_guard lock(mutex_);
    table_ = {};
    dirty_ = true;
    all_added_ = false;
  }
  changed_.notify_one();
}

tl::expected<void, std::string> InterestRegistry::note(const std::string& station,
                                                       const std::string& pattern,
                                                       std::optional<Duration> refresh) {
  {
    const std::lock_guard lock(mutex_);
    if (auto noted = table_.note(station, pattern, refresh); !noted) return noted;
    dirty_ = true;
  }
  changed_.notify_one();
  return {};
}

void InterestRegistry::run() {
  pthread_setname_np(pthread_self(), "interests");
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || dirty_; });
    if (ending_) return;
    dirty_ = false;
    const auto added = all_added_ ? table_.take_new() : std::vector<InterestTable::NewInterest>{};
    const InterestTable table = table_;
    const Buses buses = buses_;
    lock.unlock();
    std::vector<const BusSpec*> specs;
    for (const auto& [name, bus] : buses) specs.push_back(&bus->spec);
    const InterestTable::InputRefreshes inputs = table.input_refreshes(specs);
    for (const auto& [name, bus] : buses) update(table.interests(bus->spec, inputs), *bus);
    remark_on(added, buses);
    lock.lock();
    changed_.wait_for(lock, kPace, [this] { return ending_; });
  }
}

void InterestRegistry::update(std::map<ChannelIndex, Duration> interests, Bus& bus) {
  auto changed = changes(bus.known, interests);
  bus.known = std::move(interests);
  const std::lock_guard lock(bus.mutex);
  if (!changed.empty() && bus.runner) bus.runner->post(std::move(changed));
}

void InterestRegistry::remark_on(const std::vector<InterestTable::NewInterest>& added,
                                 const Buses& buses) {
  for (const InterestTable::NewInterest& one : added) {
    InterestTable::Reach reach;
    for (const auto& [name, bus] : buses) reach += InterestTable::reach(one.pattern, bus->spec);
    if (reach.on_interest != 0) continue;
    const auto verdict = remarked_.occurred(one.station, steady_now());
    if (!verdict.log) continue;
    remark_(fmt::format(
        "the interest of station {} in {} changes nothing: {}{}", one.station, one.pattern.text(),
        reach.channels == 0
            ? "no channel of this bridge matches"
            : "its channels are read anyway, at their configured refresh (acquire: always)",
        verdict.suppressed == 0
            ? ""
            : fmt::format("; so did {} more of its interests", verdict.suppressed)));
  }
}

}  // namespace fieldcast

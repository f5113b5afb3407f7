#include "core/calculate/calculator.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace fieldcast {
namespace {

struct Numbered {
  ChannelIndex index;
  const ChannelSpec* spec;
};

std::map<ChannelPath, Numbered> channels_of(const BusSpec& bus) {
  std::map<ChannelPath, Numbered> all;
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus.devices)
    for (const ChannelSpec& channel : device.channels)
      all.emplace(ChannelPath{bus.name, device.name, channel.name}, Numbered{index++, &channel});
  return all;
}

bool calculates(const BusSpec& bus) {
  return std::ranges::any_of(bus.devices, [](const DeviceSpec& device) {
    return std::ranges::any_of(device.channels, [](const ChannelSpec& channel) {
      return static_cast<bool>(channel.calculation);
    });
  });
}

// Appends the channel behind the calculated channels that it uses.
void append(const Numbered& channel, const std::map<ChannelPath, Numbered>& all,
            std::set<ChannelIndex>& seen, std::vector<Numbered>& order) {
  if (!seen.insert(channel.index).second) return;
  for (const ChannelPath& input : channel.spec->calculation.value->inputs) {
    const auto found = all.find(input);
    if (found != all.end() && found->second.spec->calculation)
      append(found->second, all, seen, order);
  }
  order.push_back(channel);
}

}  // namespace

std::vector<ChannelPath> foreign_inputs(const BusSpec& bus) {
  std::vector<ChannelPath> found;
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      if (!channel.calculation) continue;
      for (const ChannelPath& input : channel.calculation.value->inputs)
        if (input.bus != bus.name) found.push_back(input);
    }
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Calculator::Calculator(const BusSpec& bus) {
  if (!calculates(bus)) return;
  const auto all = channels_of(bus);
  const std::vector<ChannelPath> foreign = foreign_inputs(bus);
  uses_.resize(all.size());
  foreign_.resize(foreign.size());
  std::set<ChannelIndex> seen;
  std::vector<Numbered> order;
  for (const auto& [path, channel] : all)
    if (channel.spec->calculation) append(channel, all, seen, order);
  for (const Numbered& channel : order) {
    const Calculation& calculation = *channel.spec->calculation.value;
    for (std::size_t i = 0; i < calculation.inputs.size(); ++i) {
      const ChannelPath& input = calculation.inputs[i];
      const auto own = all.find(input);
      Uses& uses = own != all.end()
                       ? uses_[own->second.index]
                       : foreign_[static_cast<std::size_t>(
                             std::ranges::lower_bound(foreign, input) - foreign.begin())];
      uses.push_back({entries_.size(), i});
    }
    entries_.push_back({channel.index, channel.spec->encoding.type, calculation.compile(),
                        std::vector<InputState>(calculation.inputs.size())});
  }
}

void Calculator::take(const Uses& uses, const InputState& state) {
  for (const Use& use : uses) {
    entries_[use.entry].inputs[use.argument] = state;
    entries_[use.entry].changed = true;
  }
}

void Calculator::take(std::span<const Sample> samples) {
  if (empty()) return;
  for (const Sample& sample : samples)
    if (const Uses& uses = uses_[sample.channel]; !uses.empty()) take(uses, state_of(sample));
}

void Calculator::take(std::span<const InputSample> samples) {
  for (const InputSample& each : samples)
    if (each.input < foreign_.size())
      take(foreign_[each.input], {each.value, each.quality, each.device_code, each.acquired});
}

void Calculator::update(const Publish& publish) {
  for (Entry& entry : entries_) {
    if (!entry.changed) continue;
    entry.changed = false;
    const Calculated result = evaluate(entry.formula, entry.inputs, entry.type);
    publish(entry.channel, result);
    const Uses& uses = uses_[entry.channel];
    if (uses.empty()) continue;
    // A result without quality GOOD has no value; its users do not evaluate it.
    take(uses, state_of({.channel = entry.channel,
                         .value = result.value,
                         .quality = result.quality,
                         .device_code = result.device_code,
                         .acquired = result.acquired}));
  }
}

}  // namespace fieldcast

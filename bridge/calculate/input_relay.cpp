#include "bridge/calculate/input_relay.hpp"

#include <algorithm>
#include <utility>

#include "core/calculate/calculator.hpp"

namespace fieldcast {

std::vector<InputSample> InputRelay::Receiver::fetch() {
  const std::lock_guard lock(mutex);
  posted = false;
  std::vector<InputSample> samples;
  for (std::optional<InputSample>& each : pending)
    if (each) samples.push_back(*std::exchange(each, std::nullopt));
  return samples;
}

namespace {

std::optional<ChannelIndex> index_of(const BusSpec& bus, const ChannelPath& path) {
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus.devices) {
    if (device.name == path.device) {
      const auto found = std::ranges::find(device.channels, path.channel, &ChannelSpec::name);
      if (found == device.channels.end()) return std::nullopt;
      return index + static_cast<ChannelIndex>(found - device.channels.begin());
    }
    index += static_cast<ChannelIndex>(device.channels.size());
  }
  return std::nullopt;
}

}  // namespace

// Finds the channels of the source that are inputs of other buses.
void InputRelay::route(const BusSpec& source) {
  Targets targets;
  for (const auto& [name, known] : buses_) {
    for (std::size_t i = 0; i < known.inputs.size(); ++i) {
      if (known.inputs[i].bus != source.name) continue;
      if (const auto channel = index_of(source, known.inputs[i]))
        targets.emplace(*channel, Target{name, i});
    }
  }
  if (targets.empty()) return void(routes_.erase(source.name));
  routes_.insert_or_assign(source.name, std::move(targets));
}

void InputRelay::add(const BusSpec& spec, const std::vector<BusSpec>& all, Bus bus) {
  const std::lock_guard lock(mutex_);
  std::vector<ChannelPath> inputs = foreign_inputs(spec);
  const bool receives = !inputs.empty();
  auto receiver = std::make_shared<Receiver>(inputs.size());
  buses_.insert_or_assign(spec.name, Known{std::move(bus), std::move(inputs), std::move(receiver)});
  used_ = used_ || receives;
  if (!used_) return;
  for (const BusSpec& source : all) {
    const auto known = buses_.find(source.name);
    const bool affected = receives || source.name == spec.name;
    if (known == buses_.end() || !affected) continue;
    route(source.name == spec.name ? spec : source);
    // What is not good was published once, perhaps before the receiver existed.
    if (routes_.contains(source.name)) known->second.bus.repeat();
  }
}

void InputRelay::remove(const std::string& bus) {
  const std::lock_guard lock(mutex_);
  buses_.erase(bus);
  const auto targets = routes_.extract(bus);
  if (targets.empty()) return;
  for (const auto& [channel, target] : targets.mapped())
    put(target, {.input = target.input, .quality = Quality::kUncertain});
}

void InputRelay::publish(std::string_view bus, std::span<const Sample> samples) {
  if (!used_) return;
  const std::lock_guard lock(mutex_);
  const auto targets = routes_.find(bus);
  if (targets == routes_.end()) return;
  for (const Sample& sample : samples) {
    const auto [begin, end] = targets->second.equal_range(sample.channel);
    for (auto each = begin; each != end; ++each) {
      const InputState state = state_of(sample);
      put(each->second,
          {each->second.input, state.value, state.quality, state.device_code, state.acquired});
    }
  }
}

void InputRelay::put(const Target& target, InputSample sample) {
  const auto known = buses_.find(target.bus);
  if (known == buses_.end()) return;
  const std::shared_ptr<Receiver>& receiver = known->second.receiver;
  {
    const std::lock_guard lock(receiver->mutex);
    if (target.input >= receiver->pending.size()) return;
    receiver->pending[target.input] = sample;
    if (std::exchange(receiver->posted, true)) return;
  }
  known->second.bus.deliver([receiver] { return receiver->fetch(); });
}

}  // namespace fieldcast

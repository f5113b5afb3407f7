#include "tests/campaign/plant_memory.hpp"

#include <stdexcept>

#include "core/codec/value_codec.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::test {

PlantMemory::PlantMemory(const BusSpec& whole, DeviceOf device_of)
    : whole_(whole), device_of_(std::move(device_of)) {
  for (const DeviceSpec& device : whole.devices)
    protocols_.push_back(std::move(*make_protocol(device, line_of(whole.port))));
}

void PlantMemory::begin(const BusSpec& spec, Instant now) {
  channels_.clear();
  for (DeviceIndex d = 0; d < spec.devices.size(); ++d) {
    for (const ChannelSpec& each : spec.devices[d].channels) {
      Channel channel{.device = d, .spec = &each, .area = &protocols_[d]->areas()[each.range.area]};
      channel.holds = channel.held = memory(channel, now);
      channels_.push_back(std::move(channel));
    }
  }
}

void PlantMemory::fill(DeviceIndex device, std::mt19937_64& random, Instant now) {
  sim::SimDevice& simulated = device_of_(device);
  look_all(device, now);  // includes writes since the last read
  for (const ChannelSpec& channel : whole_.devices[device].channels) {
    const Area& area = protocols_[device]->areas()[channel.range.area];
    for (std::uint32_t i = channel.range.first; i < channel.range.end(); ++i) {
      const std::uint64_t bits = random();
      if (!simulated.poke(area.name, i,
                          area.item_bits >= 64 ? bits : bits >> (64 - area.item_bits)))
        throw std::runtime_error(whole_.devices[device].name + " has no " + std::string(area.name));
    }
  }
  look_all(device, now);
}

void PlantMemory::look_all(DeviceIndex device, Instant now) {
  for (ChannelIndex c = 0; c < channels_.size(); ++c) {
    if (channels_[c].device == device) look(c, now);
  }
}

Value PlantMemory::memory(const Channel& channel, Instant now) const {
  sim::SimDevice& device = device_of_(channel.device);
  const unsigned bits = channel.area->item_bits;
  Bytes image;
  for (std::uint32_t i = channel.spec->range.first; i < channel.spec->range.end(); ++i) {
    const std::uint64_t item = device.peek(channel.area->name, i, now).value_or(0);
    for (unsigned left = bits; left >= 8; left -= 8)
      image.push_back(static_cast<std::uint8_t>(item >> (left - 8)));
    if (bits < 8) image.push_back(static_cast<std::uint8_t>(item));
  }
  auto value = decode_value(channel.spec->encoding, bits, image);
  if (!value) throw std::runtime_error(channel.spec->name + ": no value");
  return std::move(*value);
}

void PlantMemory::look(ChannelIndex index, Instant now) {
  Channel& channel = channels_[index];
  Value value = memory(channel, now);
  if (value == channel.holds) return;
  channel.held = std::move(channel.holds);
  channel.holds = std::move(value);
  channel.changed = now;
}

std::optional<std::string> PlantMemory::wrong(ChannelIndex index, const Value& value, Instant now) {
  Channel& channel = channels_[index];
  if (value == channel.holds) return std::nullopt;
  look(index, now);
  if (value == channel.holds) return std::nullopt;
  if (value == channel.held && now - channel.changed < kOldValueMayCome) return std::nullopt;
  return "channel " + std::to_string(index) + " shows " + to_text(value) + " as good, it holds " +
         to_text(channel.holds);
}

}  // namespace fieldcast::test

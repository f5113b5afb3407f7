#include "core/model/overlap.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace fieldcast {
namespace {

// A channel and the items of its value, without the item of its exponent, which several share.
struct Whole {
  const ChannelSpec* channel;
  Range range;
};

Whole whole_of(const ChannelSpec& channel) {
  Range range = channel.range;
  Encoding plain = channel.encoding;
  if (const std::int32_t distance = std::exchange(plain.exponent_distance, 0); distance != 0) {
    if (distance < 0) range.first += static_cast<std::uint32_t>(-distance);
    range.count = item_count(plain, 16);
  }
  return {&channel, range};
}

bool same_value(const Whole& a, const Whole& b) {
  return a.range == b.range && a.channel->encoding.type == b.channel->encoding.type;
}

std::vector<Whole> whole_values(const DeviceSpec& device) {
  std::vector<Whole> channels;
  for (const ChannelSpec& channel : device.channels) {
    if (!channel.encoding.bit && !channel.calculation) channels.push_back(whole_of(channel));
  }
  std::stable_sort(channels.begin(), channels.end(), [](const Whole& a, const Whole& b) {
    return std::tuple(a.range.area, a.range.first, a.range.end()) <
           std::tuple(b.range.area, b.range.first, b.range.end());
  });
  return channels;
}

std::string described(const DeviceSpec& device, const ChannelSpec& channel) {
  return device.name + '/' + channel.name + " (" + channel.at + ", " + to_text(channel.encoding) +
         ')';
}

}  // namespace

std::vector<Overlap> overlaps_of(const BusSpec& bus) {
  std::vector<Overlap> found;
  for (const DeviceSpec& device : bus.devices) {
    const Whole* reaching = nullptr;  // of those before, the one that ends last
    const Whole* before = nullptr;
    const std::vector<Whole> channels = whole_values(device);
    for (const Whole& channel : channels) {
      for (const Whole* other : {reaching, before}) {
        if (other == nullptr || other->range.area != channel.range.area ||
            other->range.end() <= channel.range.first || same_value(*other, channel))
          continue;
        found.push_back({&device, other->channel, channel.channel});
        break;
      }
      if (reaching == nullptr || reaching->range.area != channel.range.area ||
          channel.range.end() > reaching->range.end())
        reaching = &channel;
      before = &channel;
    }
  }
  return found;
}

std::string to_text(const Overlap& overlap) {
  return described(*overlap.device, *overlap.first) + " and " +
         described(*overlap.device, *overlap.second) +
         " overlap in another type: is one of the addresses off by one?";
}

}  // namespace fieldcast

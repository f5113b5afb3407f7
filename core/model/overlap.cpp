#include "core/model/overlap.hpp"

#include <algorithm>
#include <tuple>

namespace fieldcast {
namespace {

bool same_value(const ChannelSpec& a, const ChannelSpec& b) {
  return a.range == b.range && a.encoding.type == b.encoding.type;
}

std::vector<const ChannelSpec*> whole_values(const DeviceSpec& device) {
  std::vector<const ChannelSpec*> channels;
  for (const ChannelSpec& channel : device.channels) {
    if (!channel.encoding.bit) channels.push_back(&channel);
  }
  std::stable_sort(channels.begin(), channels.end(), [](const auto* a, const auto* b) {
    return std::tuple(a->range.area, a->range.first, a->range.end()) <
           std::tuple(b->range.area, b->range.first, b->range.end());
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
    const ChannelSpec* reaching = nullptr;  // the previous channel that ends last
    const ChannelSpec* before = nullptr;
    for (const ChannelSpec* channel : whole_values(device)) {
      for (const ChannelSpec* other : {reaching, before}) {
        if (other == nullptr || other->range.area != channel->range.area ||
            other->range.end() <= channel->range.first || same_value(*other, *channel))
          continue;
        found.push_back({&device, other, channel});
        break;
      }
      if (reaching == nullptr || reaching->range.area != channel->range.area ||
          channel->range.end() > reaching->range.end())
        reaching = channel;
      before = channel;
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

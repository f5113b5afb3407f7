// Key for looking up a channel path without allocation. Pure values.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {

// Does not own its texts.
struct PathView {
  PathView(std::string_view of_bus, std::string_view of_device, std::string_view of_channel)
      : bus(of_bus), device(of_device), channel(of_channel) {}
  PathView(const ChannelPath& path)  // NOLINT: a path is a view of itself
      : bus(path.bus), device(path.device), channel(path.channel) {}

  [[nodiscard]] ChannelPath owned() const {
    return {std::string(bus), std::string(device), std::string(channel)};
  }

  std::string_view bus, device, channel;
};

struct PathHash {
  using is_transparent = void;
  std::size_t operator()(const PathView& path) const {
    const std::hash<std::string_view> hash;
    return (hash(path.bus) * 31 + hash(path.device)) * 31 + hash(path.channel);
  }
};

struct PathEqual {
  using is_transparent = void;
  bool operator()(const PathView& a, const PathView& b) const {
    return a.channel == b.channel && a.device == b.device && a.bus == b.bus;
  }
};

}  // namespace fieldcast::web

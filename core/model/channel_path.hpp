// How people and programs name one channel: "BUS/DEVICE/CHANNEL". A pure value.
#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast {

struct ChannelPath {
  std::string bus, device, channel;

  // "BUS/DEVICE/CHANNEL", all three; the fault is a line for people.
  [[nodiscard]] static tl::expected<ChannelPath, std::string> parse(std::string_view text);
  [[nodiscard]] std::string text() const { return bus + '/' + device + '/' + channel; }
  friend auto operator<=>(const ChannelPath&, const ChannelPath&) = default;
};

}  // namespace fieldcast

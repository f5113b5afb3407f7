// The name of one channel: "BUS/DEVICE/CHANNEL". Pure value.
#pragma once

#include <compare>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast {

struct ChannelPath {
  std::string bus, device, channel;

  // All three parts are required; the error is one human-readable line.
  [[nodiscard]] static tl::expected<ChannelPath, std::string> parse(std::string_view text);
  [[nodiscard]] std::string text() const { return bus + '/' + device + '/' + channel; }
  friend auto operator<=>(const ChannelPath&, const ChannelPath&) = default;
};

}  // namespace fieldcast

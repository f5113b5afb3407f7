// The name of one channel: "BUS/DEVICE/CHANNEL". Pure value.
#pragma once

#include <array>
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

// A pattern of channels: bus/device/channel, each with `*` for any characters. A shorter pattern
// matches everything below it: "press-shop" is "press-shop/*/*". Plain value.

// Matches one segment. Linear in text times stars, never exponential.
[[nodiscard]] bool glob_matches(std::string_view glob, std::string_view text);

class Pattern {
 public:
  Pattern() = default;  // matches everything

  // The error is one human-readable line: too many segments, or an empty one.
  [[nodiscard]] static tl::expected<Pattern, std::string> parse(std::string_view text);

  [[nodiscard]] bool matches(std::string_view bus, std::string_view device,
                             std::string_view channel) const;
  [[nodiscard]] bool matches(std::string_view bus, std::string_view device) const;
  [[nodiscard]] bool matches(std::string_view bus) const;

  // Always three segments: "press-shop/*/*".
  [[nodiscard]] std::string text() const;

 private:
  std::array<std::string, 3> segments_{"*", "*", "*"};
};

}  // namespace fieldcast

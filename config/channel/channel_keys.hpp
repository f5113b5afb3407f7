// Inherited defaults of bus, template, device and channel. The last level that sets a key wins.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "config/document/map_reader.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

struct ChannelDefaults {
  ChannelSpec spec;                     // values of the keys read so far
  std::optional<WordOrder> word_order;  // empty: the family's own
  std::optional<ByteOrder> byte_order;
  Charset charset = Charset::kUtf8;  // of text channels
};

// The protocol checks them when the device is complete.
struct OptionTexts {
  std::map<std::string, std::string> texts;
  std::map<std::string, Position> positions;
};

struct DeviceDefaults {
  DeviceSpec spec;  // values of the keys read so far
  OptionTexts options;
  ChannelDefaults channels;
};

// options: the last level that sets an option wins. allow: a list replaces the previous one.
void read_options(MapReader& map, DeviceDefaults& defaults);
void read_allow(MapReader& map, DeviceDefaults& defaults);

// To add a key, add a row in channel_keys.cpp.
[[nodiscard]] const Rows<ChannelDefaults>& channel_rows();
[[nodiscard]] const Rows<Limits>& limit_rows();
[[nodiscard]] const Rows<ChannelSpec>& write_rows();

// Values of `byte`: low and high are those of a word.
inline constexpr std::pair<std::string_view, std::uint8_t> kByteWords[] = {
    {"low", 0}, {"high", 1}, {"0", 0}, {"1", 1}, {"2", 2},
    {"3", 3},   {"4", 4},    {"5", 5}, {"6", 6}, {"7", 7}};

}  // namespace fieldcast::config

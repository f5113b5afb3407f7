// Inherited defaults: of the bus, the device's template, the device and the channel. The last level
// that sets a key wins.
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

}  // namespace fieldcast::config

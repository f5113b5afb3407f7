// Defaults that flow down: those of the bus, then of the device's template, then of the device,
// then of the channel. The last level that sets a key wins; each level starts with a copy of the
// one above.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

struct ChannelDefaults {
  ChannelSpec spec;                     // what the keys say so far
  std::optional<WordOrder> word_order;  // nothing: the family's own
  std::optional<ByteOrder> byte_order;
  Charset charset = Charset::kUtf8;  // of channels that are texts
};

// Options of the protocol, checked by it when the device is complete.
struct OptionTexts {
  std::map<std::string, std::string> texts;
  std::map<std::string, Position> positions;
};

struct DeviceDefaults {
  DeviceSpec spec;  // what the keys say so far
  OptionTexts options;
  ChannelDefaults channels;
};

// options: the last level that sets an option wins. allow: a list of rights replaces the one above.
void read_options(MapReader& map, DeviceDefaults& defaults);
void read_allow(MapReader& map, DeviceDefaults& defaults);

}  // namespace fieldcast::config

// Defaults that flow down: those of the bus, then of the device's template, then of the device,
// then of the channel. The last that speaks wins; each level starts with a copy of the one above.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

struct ChannelDefaults {
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;
  Access access = Access::kReadOnly;
  bool on_interest = false;
  int priority = 0;
  double elasticity = 1;
  std::optional<WordOrder> word_order;  // nothing: the family's own
  std::optional<ByteOrder> byte_order;
  Charset charset = Charset::kUtf8;
  std::optional<Duration> heartbeat;
};

// Options of the protocol, checked by it when the device is complete.
struct OptionTexts {
  std::map<std::string, std::string> texts;
  std::map<std::string, Place> places;
};

struct DeviceDefaults {
  Duration timeout = std::chrono::milliseconds{200};
  unsigned retries = 1;
  Duration pause{};
  std::uint16_t max_block = 0;
  std::optional<std::uint16_t> max_gap;
  OptionTexts options;
  bool allow_raw_read = false;
  bool allow_raw_write = false;
  ChannelDefaults channels;
};

// refresh, mode, access, acquire, priority, elasticity, word-order, byte-order, encoding,
// heartbeat.
void read_channel_defaults(MapReader& map, ChannelDefaults& defaults);

// Those, and timeout, retries, pause, max-block, max-gap.
void read_device_defaults(MapReader& map, DeviceDefaults& defaults);

// options, allow: the option that speaks last wins; a list of rights replaces the one above.
void read_options(MapReader& map, DeviceDefaults& defaults);
void read_allow(MapReader& map, DeviceDefaults& defaults);

}  // namespace fieldcast::config

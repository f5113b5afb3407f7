// Buses and devices as the files of a configuration, as a person would write them: YAML with the
// channels inline or in a channel list, or a device template. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/model.hpp"

namespace fieldcast::importing {

// A channel is on a text line of its own, so that a fault of a text line is a fault of a channel.
struct WrittenChannel {
  unsigned line = 0;  // from 1
  std::size_t bus = 0, device = 0, point = 0;
};

// The text lines that say something of a whole device, or of a bus.
struct WrittenHead {
  unsigned first = 0, last = 0;  // from 1
  std::size_t bus = 0;
  std::optional<std::size_t> device;
};

struct WrittenFile {
  std::string name;  // "plant.yaml", "devices/meter.yaml"
  std::string text;
  std::vector<WrittenChannel> channels;  // in the order of the text lines
  std::vector<WrittenHead> heads;
};

struct WriteOptions {
  std::string head;    // comment lines of every file, without '#'
  std::string bridge;  // the name of the bridge
  std::string file;    // of the configuration
  bool lists = false;  // channels in a channel list for each device, beside the configuration
};

// The configuration, first, and its channel lists.
// REQUIRES: names are unique, every bus has devices, every device has points and an address.
[[nodiscard]] std::vector<WrittenFile> write_configuration(const std::vector<Bus>& buses,
                                                           const WriteOptions& options);

// The template of one device; its `name` is empty.
[[nodiscard]] WrittenFile write_template(const Device& device, std::string_view head);

// "serial: /dev/ttyS1, baud: 9600, format: 8N1": the keys of a port.
[[nodiscard]] std::string port_text(const Port& port);

// A scalar of YAML, with quotes where it needs them.
[[nodiscard]] std::string yaml_text(std::string_view text);

}  // namespace fieldcast::importing

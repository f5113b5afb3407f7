// Writes a readable configuration: YAML, channel lists, or a device template. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

// Lines that describe a bus, a device or a channel, so that a fault of a line belongs to one of
// them. Each channel has its own line.
struct WrittenPart {
  static constexpr std::size_t kNone = SIZE_MAX;
  unsigned first = 0, last = 0;  // from 1
  std::size_t bus = 0;
  std::size_t device = kNone, point = kNone;  // kNone: the lines are of the bus, or of the device
};

struct WrittenFile {
  std::string name;  // "plant.yaml", "devices/meter.yaml"
  std::string text;
  std::vector<WrittenPart> parts;  // in the order of the lines, disjoint
};

struct WriteOptions {
  std::string head;    // comment lines of every file, without '#'
  std::string bridge;  // name of the bridge
  std::string file;    // name of the configuration file
  bool lists = false;  // writes a channel list for each device
};

// REQUIRES: names are unique, every bus has devices, every device has points and an address.
[[nodiscard]] std::vector<WrittenFile> write_configuration(const std::vector<Bus>& buses,
                                                           const WriteOptions& options);

// The template of one device; `name` of the result is empty.
[[nodiscard]] WrittenFile write_template(const Device& device, std::string_view head);

// "serial: /dev/ttyS1, baud: 9600, format: 8N1": the keys of a port.
[[nodiscard]] std::string port_text(const Port& port);

[[nodiscard]] std::string yaml_text(std::string_view text);

[[nodiscard]] std::string type_text(const Point& point);

}  // namespace fieldcast::importing

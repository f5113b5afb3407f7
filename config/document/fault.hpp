// One error of a configuration with its position. Values only; any thread.
#pragma once

#include <span>
#include <string>

namespace fieldcast::config {

struct Fault {
  std::string file;
  unsigned line = 0;       // from 1
  unsigned column = 0;     // from 1, in characters
  std::string what;        // "unknown key 'adress' in a device"
  std::string allowed;     // "name, address, protocol, ..."; may be empty
  std::string suggestion;  // "address"; may be empty
  friend bool operator==(const Fault&, const Fault&) = default;
};

// "plant.yaml:7:5: unknown key 'adress' in a device; allowed: name, address; did you mean address?"
[[nodiscard]] std::string to_text(const Fault& fault);

[[nodiscard]] std::string to_text(std::span<const Fault> faults);

}  // namespace fieldcast::config

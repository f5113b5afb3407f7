// A protocol with one choice of its options, for the master and the simulated device.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"

namespace fieldcast::sim {

struct Subject {
  std::string variant;  // "mode: fins"; empty: no options
  DeviceSpec device;    // without channels
  PortSpec port;
  bool checked = true;  // every response has a check: no flipped bit may be accepted
  std::span<const std::string_view> addresses{};  // built-in protocol: forms of its notation

  [[nodiscard]] LineFormat line() const { return line_of(port); }
  [[nodiscard]] std::unique_ptr<Protocol> protocol() const;
  // The same device at another address; empty if the protocol has only one.
  [[nodiscard]] std::optional<Subject> neighbour() const;
};

// Returns one subject for each variant of a built-in protocol; empty for an unknown name.
[[nodiscard]] std::vector<Subject> subjects_of(std::string_view protocol);
[[nodiscard]] std::vector<Subject> subjects_of(const declared::SharedDeclaration& declaration);

}  // namespace fieldcast::sim

// What `sim-check` puts to the test: a protocol with one choice of its options, as the master and
// as the simulated device.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast::sim {

struct Subject {
  std::string variant;  // "mode: fins"; empty: as it is without options
  DeviceSpec device;    // without channels
  PortSpec port;
  bool checked = true;  // every answer carries a check: no flipped bit may pass
  std::span<const std::string_view> addresses{};  // of a built-in protocol: forms of its notation

  [[nodiscard]] LineFormat line() const { return line_of(port); }
  [[nodiscard]] std::unique_ptr<Protocol> protocol() const;
  // The same at another address; nothing where there is only one.
  [[nodiscard]] std::optional<Subject> neighbour() const;
};

// One subject for each way in which a built-in protocol speaks; empty for a name that nobody has.
[[nodiscard]] std::vector<Subject> subjects_of(std::string_view protocol);
[[nodiscard]] std::vector<Subject> subjects_of(const declared::SharedDeclaration& declaration);

}  // namespace fieldcast::sim

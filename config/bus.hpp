// One bus: its port, protocol, defaults and devices.
#pragma once

#include "config/device.hpp"
#include "config/document.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Faults are noted; with faults the result is whatever could be read.
[[nodiscard]] BusSpec read_bus(const Node& node, LoadState& state);

// The silence between an answer and the next request: "standard", "3.5c" or a duration.
struct SilenceReader {
  std::optional<SilenceRule> operator()(const Node& node, std::string_view key,
                                        FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config

#pragma once

#include <optional>

#include "config/document/document.hpp"
#include "config/document/map_reader.hpp"
#include "config/sections/device.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

// Adds faults; with faults the result is incomplete.
[[nodiscard]] BusSpec read_bus(const Node& node, LoadState& state);

// The silence between a response and the next request: "standard", "3.5c" or a duration.
struct SilenceReader {
  std::optional<SilenceRule> operator()(const Node& node, std::string_view key,
                                        FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// The `capture` section of a bus.
void read_capture(MapReader& bus, std::optional<CaptureSpec>& spec);

}  // namespace fieldcast::config

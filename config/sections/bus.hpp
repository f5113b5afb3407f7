#pragma once

#include <optional>
#include <string>

#include "config/document/document.hpp"
#include "config/document/map_reader.hpp"
#include "config/sections/device.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

// Adds faults; with faults the result is incomplete.
[[nodiscard]] BusSpec read_bus(const Node& node, LoadState& state);

struct PortFault {
  std::string what, allowed;
};
// Why a port of `udp` cannot carry these devices: the network doubles, delays and reorders
// datagrams, so each response must name its request; or why another port cannot.
[[nodiscard]] std::optional<PortFault> port_fault(const BusSpec& spec);

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

// The `capture` section of a bus.
#pragma once

#include <optional>

#include "config/document/map_reader.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

void read_capture(MapReader& bus, std::optional<CaptureSpec>& spec);

// Size of one file: a whole number with kB, MB or GB.
struct CaptureSizeRule {
  std::optional<std::int64_t> operator()(const Node& node, std::string_view key,
                                         FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config

// The sections of the configuration that choose and describe the engine: one row for each.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "tools/forward/settings/configuration.hpp"

namespace fieldcast::forward {

// Adds the keys of a table to the documents; `prefix` as "jetstream.".
using AddKeys = std::function<void(const std::string& prefix, const config::RowTable& table)>;

struct OutletSection {
  std::string_view name;
  OutletSpec (*read)(config::MapReader& file, const config::Node& section,
                     config::Library& library);
  void (*document)(const AddKeys& add);
};
[[nodiscard]] std::span<const OutletSection> outlet_sections();

// Reads the one section that is there; without one, JetStream on this machine. More than one is a
// fault: run a forwarder with its own queue for each engine.
[[nodiscard]] OutletSpec read_outlet(config::MapReader& file, config::Library& library);

}  // namespace fieldcast::forward

// The record templates that come with EPICS' modbus module: which record each one makes. They are
// named by substitutions everywhere and need not be given. Pure.
//
// Source: epics-modules/modbus modbusApp/Db.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/formats/epics_files.hpp"

namespace fieldcast::importing {

// The record with its macros not yet expanded; nothing for other files.
[[nodiscard]] std::optional<EpicsRecord> module_template(std::string_view file);

// Records about the driver itself: statistics, delays, the asyn record.
[[nodiscard]] bool is_driver_template(std::string_view file);

}  // namespace fieldcast::importing

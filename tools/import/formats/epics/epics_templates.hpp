// Record templates of the EPICS modbus module, which users need not pass. Pure.
// Source: epics-modules/modbus modbusApp/Db.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/formats/epics/epics_files.hpp"

namespace fieldcast::importing {

// Its macros are unexpanded; empty for other files.
[[nodiscard]] std::optional<EpicsRecord> module_template(std::string_view file);

// Records about the driver itself: statistics, delays, the asyn record.
[[nodiscard]] bool is_driver_template(std::string_view file);

}  // namespace fieldcast::importing

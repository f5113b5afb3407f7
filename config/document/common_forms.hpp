// Texts about protocols for several tables, from the rows of core/protocol/families/registry.hpp.
#pragma once

#include <string>

namespace fieldcast::config {

// "`modbus-rtu`: `mask-write: true` ..; `dtc`: ..": the options of every protocol.
[[nodiscard]] std::string options_text();

// "19200; `s7-ppi` 9600": the factory baud rates.
[[nodiscard]] std::string factory_bauds();
// "8E1; `modbus-ascii` 7E1": the factory data bits, parity and stop bits.
[[nodiscard]] std::string factory_formats();

// "`dtc`, `modbus-rtu`, ..".
[[nodiscard]] std::string protocol_names();

}  // namespace fieldcast::config

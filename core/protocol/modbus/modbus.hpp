#pragma once

#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/modbus/request.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::modbus {

[[nodiscard]] const ProtocolEntry& rtu_entry();
[[nodiscard]] const ProtocolEntry& ascii_entry();
[[nodiscard]] const ProtocolEntry& tcp_entry();

}  // namespace fieldcast::modbus

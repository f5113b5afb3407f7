#pragma once

#include "core/protocol/field_writer.hpp"
#include "core/protocol/modbus/request.hpp"

namespace fieldcast::modbus {

// If both request and response are possible, the more plausible one is shown with a remark.
void explain_pdu(ByteView pdu, FieldWriter& writer);

[[nodiscard]] std::string unit_text(std::uint8_t unit, bool serial);  // "17", "0: broadcast"

}  // namespace fieldcast::modbus

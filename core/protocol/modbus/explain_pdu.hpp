// Explains the PDU inside any of the three framings.
#pragma once

#include "core/protocol/field_writer.hpp"
#include "core/protocol/modbus/function.hpp"

namespace fieldcast::modbus {

// Adds the lines of a PDU. Request or answer is told from its length and fields; where both
// readings hold, the more plausible one is shown and the other remarked.
void explain_pdu(ByteView pdu, FieldWriter& writer);

[[nodiscard]] std::string unit_text(std::uint8_t unit, bool serial);  // "17", "0: broadcast"

}  // namespace fieldcast::modbus

// What an Omron PLC at a Host Link port says of itself. Harmless: both questions are reads.
//
//     @ uu MM FCS * CR                     ->  @ uu MM 00 cc FCS * CR          cc: model code
//     @ uu FA 0 00 00 00 SID 0501 00 ..    ->  @ uu FA 00 .. 0000 model(20) version(20) ..
//
// The second one follows where the code says CS or CJ: these share one code (30), and FINS knows
// the name of the CPU. Pure; nothing fails but the exchange.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// Its reply is one range whose items are the text: "CS/CJ (model code 30), CS1H-CPU67H, 04.00".
[[nodiscard]] std::unique_ptr<Exchange> hostlink_identity(std::uint16_t unit);

// "C250 (model code 01)"; a code that no manual names: "unknown model (model code 5A)".
[[nodiscard]] std::string hostlink_model_text(std::uint8_t code);

}  // namespace fieldcast::cli

// Identifies an Omron PLC at a Host Link port by two read requests. Pure.
//
//     @ uu MM FCS * CR                     ->  @ uu MM 00 cc FCS * CR          cc: model code
//     @ uu FA 0 00 00 00 SID 0501 00 ..    ->  @ uu FA 00 .. 0000 model(20) version(20) ..
//
// The second request follows if the code means CS or CJ: these share code 30, and only FINS returns
// the name of the CPU.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// The reply is one range with the text: "CS/CJ (model code 30), CS1H-CPU67H, 04.00".
[[nodiscard]] std::unique_ptr<Exchange> hostlink_identity(std::uint16_t unit);

// "C250 (model code 01)"; for an unknown code "unknown model (model code 5A)".
[[nodiscard]] std::string hostlink_model_text(std::uint8_t code);

}  // namespace fieldcast::cli

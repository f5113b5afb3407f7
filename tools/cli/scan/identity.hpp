// Requests that identify a device. Each is a read and changes nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// The protocol's own identification request, whose reply is one range with the text. Modbus:
// function 43, MEI type 14, "Vendor, Product, 1.2" (Modbus Application Protocol V1.1b3, 6.21). Host
// Link: omron_identity.hpp. Null: the protocol has none.
[[nodiscard]] std::unique_ptr<Exchange> identity_exchange(std::string_view protocol,
                                                          std::uint16_t address);

// Address of the device type in a family: D8001 of an FX, SMB6 of an S7-200.
struct TypeAddress {
  std::string_view at;
  std::string_view label;  // "type and version"
};
[[nodiscard]] std::optional<TypeAddress> type_address(std::string_view protocol);

// Identifies an Omron PLC at a Host Link port by two read requests. Pure.
//
//     @ uu MM FCS * CR                     ->  @ uu MM 00 cc FCS * CR          cc: model code
//     @ uu FA 0 00 00 00 SID 0501 00 ..    ->  @ uu FA 00 .. 0000 model(20) version(20) ..
//
// The second request follows if the code means CS or CJ: these share code 30, and only FINS returns
// the name of the CPU.
// The reply is one range with the text: "CS/CJ (model code 30), CS1H-CPU67H, 04.00".
[[nodiscard]] std::unique_ptr<Exchange> hostlink_identity(std::uint16_t unit);

// "C250 (model code 01)"; for an unknown code "unknown model (model code 5A)".
[[nodiscard]] std::string hostlink_model_text(std::uint8_t code);

}  // namespace fieldcast::cli

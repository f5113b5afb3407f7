// Requests that identify a device. Each is a read and changes nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"
#include "tools/cli/scan/scan_plan.hpp"

namespace fieldcast::cli {

// The protocol's own identification request, whose reply is one range with the text. Host Link:
// hostlink_identity(). Controllers on a network: controller_identity(). Null: the protocol has
// none; an item may identify the device (identity_question()).
[[nodiscard]] std::unique_ptr<Exchange> identity_exchange(const ScanLine& line,
                                                          std::uint16_t address,
                                                          ExchangeContext context = {});

// Identifies an Omron PLC at a Host Link port by two read requests. Pure.
//
//     @ uu MM FCS * CR                     ->  @ uu MM 00 cc FCS * CR          cc: model code
//     @ uu FA 0 00 00 00 SID 0501 00 ..    ->  @ uu FA 00 .. 0000 model(20) version(20) ..
//
// The second request follows if the code means CS or CJ: these share code 30, and only FINS returns
// the name of the CPU.
// The reply is one range with the text: "CS/CJ (model code 30), CS1H-CPU67H, 04.00".
[[nodiscard]] std::unique_ptr<Exchange> hostlink_identity(std::uint16_t unit);

// Identifies a controller on a connection that has had an exchange. Each part that the controller
// refuses is missing in the text. Null for another protocol.
//
//   s7-tcp         system status lists 0011 and 001C (names), 0131 (connections)
//                  "CPU 315-2 PN/DP, 6ES7 315-2EH14-0AB0, V3.2.6, PDU 240 bytes, 16 connections"
//   mitsubishi-mc  command 0101: "Q03UDECPU (code 0268)"       (SH-080008, read CPU model name)
//   omron-fins     command 0501: "CJ2M-CPU35, 02.01"           (W342, 5-3-15)
[[nodiscard]] std::unique_ptr<Exchange> controller_identity(const ScanLine& line,
                                                            ExchangeContext context);

// "C250 (model code 01)"; for an unknown code "unknown model (model code 5A)".
[[nodiscard]] std::string hostlink_model_text(std::uint8_t code);

}  // namespace fieldcast::cli

// FINS commands (fins_command.hpp) in Host Link frames with the header FA.
//
//     request   @ uu FA w ICF DA2 SA2 SID command.. FCS * CR
//     request   @ uu FA w ICF RSV GCT DNA DA1 DA2 SNA SA1 SA2 SID command.. FCS * CR
//     response  @ uu FA ee ICF .. SID command(2) end(2) data.. FCS * CR
//
// The first form addresses the CPU on the line (ICF 00), the second one another node (ICF 80). A
// response has ICF 40 or C0 and the fields of its request.
// w: the PLC waits w * 10 ms before it responds. Two digits per byte (Omron W227 and W342).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/protocol/omron_hostlink/areas.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::omron {

struct FinsRoute {
  std::uint16_t host_unit = 0;  // on the serial line
  std::uint8_t wait = 0;        // w
  bool relayed = false;
  std::uint8_t network = 0;  // DNA, DA1; only if relayed
  std::uint8_t node = 0;
  std::uint8_t unit = 0;  // DA2
};

[[nodiscard]] std::optional<ExchangeSize> fins_size(const FinsRoute& route, const Request& request);
// REQUIRES: fins_size(route, request) holds a value.
[[nodiscard]] std::unique_ptr<Exchange> begin_fins(const FinsRoute& route, std::uint8_t sid,
                                                   const Request& request);

// An example of each form of address.
inline constexpr std::string_view kFinsAddresses[] = {
    "CIO12", "IR13", "CIO14.03", "W5",   "WR6",      "W7.07",   "HR10", "H11",
    "AR3",   "A4",   "DM100",    "D101", "DM102.15", "EM1_100", "EC_5", "E1_102.3",
    "T5",    "TIM6", "C5",       "CNT6", "TF5",      "TIMF6",   "CF5",  "CNTF6"};

// End codes of FINS messages (W227, 5), after those of the Host Link frames. FINS 0001 replaces
// Host Link 01 (RUN mode), which no frame with FINS brings.
inline constexpr auto kFinsCodes = joined_codes(
    [] {
      auto codes = kEndCodes;
      *std::ranges::find(codes, 0x0001, &DeviceCode::code) =
          DeviceCode{0x0001, "service interrupted", Cause::kDeviceBusy, true};
      return codes;
    }(),
    std::array{
        DeviceCode{0x0100, "error of the local node", Cause::kDeviceBusy},
        DeviceCode{0x0200, "destination cannot be reached", Cause::kDeviceBusy},
        DeviceCode{0x0204, "destination busy", Cause::kDeviceBusy},
        DeviceCode{0x0205, "destination did not respond", Cause::kDeviceBusy, true},
        DeviceCode{0x0300, "error of the controller or the CPU unit", Cause::kDeviceBusy},
        DeviceCode{0x0401, "undefined command"},
        DeviceCode{0x0402, "not supported by this model"},
        DeviceCode{0x0500, "routing error"},
        DeviceCode{0x1001, "command too long"},
        DeviceCode{0x1002, "command too short"},
        DeviceCode{0x1003, "item count differs from the data"},
        DeviceCode{0x1004, "command format error"},
        DeviceCode{0x1005, "header error"},
        DeviceCode{0x1101, "no such memory area"},
        DeviceCode{0x1102, "access size error"},
        DeviceCode{0x1103, "start address out of range"},
        DeviceCode{0x1104, "end of the range out of range"},
        DeviceCode{0x1106, "no such program"},
        DeviceCode{0x110B, "response too long"},
        DeviceCode{0x110C, "parameter error"},
        DeviceCode{0x2000, "read refused"},
        DeviceCode{0x2100, "write refused"},
        DeviceCode{0x2200, "wrong mode", Cause::kDeviceBusy},
        DeviceCode{0x2201, "wrong mode: running", Cause::kDeviceBusy},
        DeviceCode{0x2203, "wrong mode: PROGRAM", Cause::kDeviceBusy},
        DeviceCode{0x2206, "wrong mode: RUN", Cause::kDeviceBusy},
        DeviceCode{0x2300, "no such unit"},
        DeviceCode{0x2502, "checksum error in memory", Cause::kDeviceBusy},
        DeviceCode{0x2600, "protected"},
        DeviceCode{0x3001, "no access right", Cause::kDeviceBusy},
        DeviceCode{0x4001, "aborted", Cause::kDeviceBusy, true},
    });
[[nodiscard]] std::string_view fins_end_text(std::uint16_t code);  // "start address out of range"

}  // namespace fieldcast::omron

// Commands of SLC 500 and MicroLogix controllers (1770-6.5.16, 7-17 and 7-18), and their responses.
//
//     read    DST SRC 0F 00 TNS A2 size file type element sub           ->  SRC DST 4F STS TNS data
//     write   DST SRC 0F 00 TNS AA size file type element sub data      ->  SRC DST 4F STS TNS
//     bit     DST SRC 0F 00 TNS AB 02 file type element sub mask data   ->  SRC DST 4F STS TNS
//
// The size is in bytes. A number from 255 on is FF and two bytes. The low byte of numbers is first.
// A refusal has STS, and with STS F0 the byte EXT STS instead of data.
#pragma once

#include <array>
#include <cstdint>

#include "core/protocol/allen_bradley_df1/areas.hpp"
#include "core/protocol/device_code.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::df1 {

inline constexpr std::uint8_t kCommand = 0x0F, kReply = 0x40, kExtended = 0xF0;
inline constexpr std::uint8_t kRead = 0xA2, kWrite = 0xAA, kWriteMasked = 0xAB;

struct Nodes {
  std::uint32_t plc = 1, source = 0;  // 0..254
};

constexpr auto kBusy = Cause::kDeviceBusy;
// STS, or F000h + EXT STS (1770-6.5.16, chapter 8).
inline constexpr DeviceCode kCodes[] = {
    {0x01, "node has no buffer space", kBusy},
    {0x02, "node does not acknowledge", kBusy, true},
    {0x04, "port of the gateway is disconnected", kBusy},
    {0x05, "gateway got no response", kBusy, true},
    {0x07, "station is offline", kBusy},
    {0x08, "hardware fault of the gateway", kBusy},
    {0x10, "illegal command or format"},
    {0x20, "host does not communicate", kBusy},
    {0x30, "remote node is missing or shut down", kBusy},
    {0x40, "hardware fault of the host", kBusy},
    {0x50, "address does not exist, or is protected"},
    {0x60, "function is not allowed by the protection"},
    {0x70, "processor is in program mode", kBusy},
    {0x80, "compatibility file is missing"},
    {0x90, "remote node cannot buffer the command", kBusy},
    {0xB0, "program is being downloaded", kBusy},
    {0xC0, "gateway waits for an acknowledgement", kBusy},
    {0xF000, "error in the extended status"},
    {0xF001, "a field has an illegal value"},
    {0xF006, "address does not exist"},
    {0xF007, "file has a wrong size"},
    {0xF008, "situation has changed since the start of the command", kBusy},
    {0xF009, "data or file is too large"},
    {0xF00B, "access denied"},
    {0xF00C, "resource is not available", kBusy},
    {0xF00E, "command cannot be executed"},
    {0xF010, "no access"},
    {0xF011, "illegal data type"},
    {0xF012, "invalid parameter or data"},
    {0xF014, "command failed for an unknown reason"},
    {0xF01A, "file is open by another node", kBusy},
    {0xF01B, "another node owns the program", kBusy},
    {0xF01E, "data element is protected"},
    {0xF01F, "temporary internal problem", kBusy},
};

// Data of a packet, before doubling. REQUIRES: the request fits.
[[nodiscard]] Bytes command_of(const Request& request, const Nodes& nodes, std::uint16_t tns);

// Bytes of the packet of the response.
[[nodiscard]] std::size_t response_size(const Request& request);

struct Judgement {
  Cause cause = Cause::kNone;  // kNone: the response; kForeign, kMalformed, or of the refusal
  std::uint16_t code = 0;      // of a refusal
  Reply reply{};
};
// `packet`: data with a valid check, of any size.
[[nodiscard]] Judgement judge(ByteView packet, const Request& request, const Nodes& nodes,
                              std::uint16_t tns);

}  // namespace fieldcast::df1

// What stands before a frame in a capture of LINKTYPE_WIRESHARK_UPPER_PDU: tags that say which
// dissector takes it.
//
//   TAG(2) LENGTH(2) VALUE, padded to 4 bytes .. 00 00 00 00  frame       all big-endian
//
// The tags are those of Wireshark's epan/exported_pdu.h. Pure, any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/capture/capture_record.hpp"

namespace fieldcast {

// Modbus has no direction in its frames. Its dissectors go by the port, and 502 is the device.
inline constexpr std::uint16_t kDevicePort = 502, kMasterPort = 49152;

// `column`: what the list of packets shows as the protocol; empty: what the dissector says.
[[nodiscard]] Bytes make_upper_pdu(std::string_view dissector, std::string_view column,
                                   Direction direction, ByteView frame);

struct UpperPdu {
  std::string dissector;  // empty: none is named
  std::string column;
  std::optional<std::uint32_t> source_port, destination_port;
  ByteView frame;  // of the bytes that were given
};
// Nothing: the tags do not end.
[[nodiscard]] std::optional<UpperPdu> parse_upper_pdu(ByteView bytes);

}  // namespace fieldcast

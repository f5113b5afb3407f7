// Tags before a frame in a capture of LINKTYPE_WIRESHARK_UPPER_PDU, which select its dissector.
// Tags from Wireshark's epan/exported_pdu.h. Pure, any thread.
//
//   TAG(2) LENGTH(2) VALUE, padded to 4 bytes .. 00 00 00 00  frame       all big-endian
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/capture/capture_record.hpp"

namespace fieldcast {

// Modbus frames have no direction. Its dissectors use the port, and 502 is the device.
inline constexpr std::uint16_t kDevicePort = 502, kMasterPort = 49152;

// `column`: protocol column of the packet list; empty: chosen by the dissector.
[[nodiscard]] Bytes make_upper_pdu(std::string_view dissector, std::string_view column,
                                   Direction direction, ByteView frame);

struct UpperPdu {
  std::string dissector;  // empty if missing
  std::string column;
  std::optional<std::uint32_t> source_port, destination_port;
  ByteView frame;  // refers to the given bytes
};
// Empty if the tags have no end.
[[nodiscard]] std::optional<UpperPdu> parse_upper_pdu(ByteView bytes);

}  // namespace fieldcast

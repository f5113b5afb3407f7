// Constants of draft-ietf-opsawg-pcapng with its sections, and the link type of
// www.tcpdump.org/linktypes.html.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/capture/capture_record.hpp"

namespace fieldcast::pcapng {

// Block types (11.1).
inline constexpr std::uint32_t kSectionHeader = 0x0A0D0D0A;   // 4.1
inline constexpr std::uint32_t kInterfaceDescription = 1;     // 4.2
inline constexpr std::uint32_t kSimplePacket = 3;             // 4.4
inline constexpr std::uint32_t kInterfaceStatistics = 5;      // 4.6
inline constexpr std::uint32_t kEnhancedPacket = 6;           // 4.3
inline constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;  // 4.1
inline constexpr std::uint32_t kOldPcapMagic = 0xA1B2C3D4;    // of the older pcap format
inline constexpr std::uint32_t kOldPcapNanoMagic = 0xA1B23C4D;

// Options (3.5).
inline constexpr std::uint16_t kEndOfOptions = 0, kComment = 1;
inline constexpr std::uint16_t kSectionApplication = 4;                          // 4.1
inline constexpr std::uint16_t kIfName = 2, kIfDescription = 3, kIfTsresol = 9;  // 4.2
inline constexpr std::uint16_t kIfTsoffset = 14;
inline constexpr std::uint16_t kPacketFlags = 2;  // 4.3.1: bits 0 and 1 are the direction
inline constexpr std::uint32_t kInbound = 1, kOutbound = 2;
inline constexpr std::uint16_t kIfStart = 2, kIfEnd = 3, kIfReceived = 4, kIfDropped = 5;  // 4.6

inline constexpr std::uint16_t kLinktypeUpperPdu = 252;

// Limit of blocks, for writer and reader.
inline constexpr std::size_t kMaxBlock = 1 << 20;  // bytes

}  // namespace fieldcast::pcapng

namespace fieldcast {

// Tags before a frame in a capture of LINKTYPE_WIRESHARK_UPPER_PDU, which select its dissector.
// Tags from Wireshark's epan/exported_pdu.h. Pure, any thread.
//
//   TAG(2) LENGTH(2) VALUE, padded to 4 bytes .. 00 00 00 00  frame       all big-endian

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

namespace fieldcast::pcapng {

// Writes the blocks of a pcapng file: one section, one interface, packets with microseconds,
// direction and comment, and the number of lost packets. Little-endian. Each appends one whole
// block.

// Starts a file. Both texts are one human-readable line.
void append_section(Bytes& out, std::string_view application, std::string_view comment);
void append_interface(Bytes& out, std::string_view name, std::string_view description);

struct Packet {
  UtcTime at;
  Direction direction = Direction::kReceived;
  ByteView data;             // with its tags (upper_pdu.hpp)
  std::string_view comment;  // empty if there is none
};
// REQUIRES: an interface precedes it; data and comment have less than 60 000 bytes each.
void append_packet(Bytes& out, const Packet& packet);

struct Statistics {
  UtcTime begun, ended;
  std::uint64_t frames = 0, dropped = 0;
  std::string_view comment;
};
void append_statistics(Bytes& out, const Statistics& statistics);

}  // namespace fieldcast::pcapng

// Constants of draft-ietf-opsawg-pcapng with its sections, and the link type of
// www.tcpdump.org/linktypes.html.
#pragma once

#include <cstddef>
#include <cstdint>

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

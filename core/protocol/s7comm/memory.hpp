// The memory of a CPU as S7 messages address it.
#pragma once

#include <cstdint>
#include <span>

#include "core/protocol/protocol.hpp"

namespace fieldcast::s7comm {

struct AreaCode {
  std::uint8_t code = 0;
  std::uint8_t transport = 2;  // TS: 02 bytes, 04 words, or the area code itself
  std::uint8_t item_size = 1;  // maximum bytes of one item in a response
  bool counted = false;        // addressed by number instead of by bit
  std::uint16_t block = 0;     // number of the data block
  bool blocks = false;         // all data blocks, from 1 on, kBlockBytes items each
};

inline constexpr std::uint32_t kBlockBytes = 65536, kBlocks = 65535;

// Bytes of a message without the values of one item (computed as in libnodave).
inline constexpr std::size_t kReadOverhead = 18, kWriteOverhead = 28;
inline constexpr std::size_t kSmallestPdu = 240, kLargestPdu = 960;

struct Memory {
  std::span<const Area> areas;
  std::span<const AreaCode> codes;  // one for each area
  std::size_t pdu = kSmallestPdu;   // maximum bytes of a message
};

}  // namespace fieldcast::s7comm

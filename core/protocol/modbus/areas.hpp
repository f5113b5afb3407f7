#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus {

enum class Table : AreaIndex { kCoil, kInput, kHolding, kInputRegister, kFile, kIdentity, kFifo };

// Application Protocol V1.1b3, 6.1-6.15; they limit every PDU to 253 bytes.
inline constexpr std::uint16_t kMaxReadBits = 2000;
inline constexpr std::uint16_t kMaxWriteBits = 1968;
inline constexpr std::uint16_t kMaxReadRegisters = 125;
inline constexpr std::uint16_t kMaxWriteRegisters = 123;
inline constexpr std::uint16_t kMaxReadWriteRegisters = 121;  // written registers of function 23
// Registers in one group of functions 20 and 21. A write may have 122: its read-back may not.
inline constexpr std::uint16_t kMaxRecords = 121;

// A file is a bank of the area `file`: record 1 of file 4 is item 40001.
inline constexpr std::uint32_t kRecords = 10000;
inline constexpr std::uint32_t kFiles = 65536;
// An object of the identification is a bank of the area `id`, one character in each item. A PDU
// carries no longer text.
inline constexpr std::uint16_t kObjectCharacters = 244;
inline constexpr std::uint32_t kObjects = 256;
// A reserved object: the basic ones (vendor, product code, revision) as one text, joined by commas.
inline constexpr std::uint32_t kBasicObjects = 127;
// A queue is a bank of the area `fifo`: its count, then the registers in their order (6.18).
inline constexpr std::uint16_t kMaxQueued = 31;
inline constexpr std::uint16_t kQueueItems = kMaxQueued + 1;

// In the order of Table. `mask_write`: function 22 for one bit or byte of a register. A client of
// the gateway requests it itself, so the device decides.
[[nodiscard]] constexpr std::array<Area, 7> areas(bool mask_write) {
  return {{
      {.name = "coil",
       .item_bits = 1,
       .writable = true,
       .max_read = kMaxReadBits,
       .max_write = kMaxWriteBits,
       .bit_write = true},
      {.name = "input", .item_bits = 1, .max_read = kMaxReadBits, .max_write = 0},
      {.name = "holding",
       .item_bits = 16,
       .writable = true,
       .max_read = kMaxReadRegisters,
       .max_write = kMaxWriteRegisters,
       .bit_write = mask_write,
       .byte_write = mask_write,
       .mask_write = true},
      {.name = "input-register", .item_bits = 16, .max_read = kMaxReadRegisters, .max_write = 0},
      {.name = "file",
       .item_bits = 16,
       .items = kFiles * kRecords,
       .writable = true,
       .max_read = kMaxRecords,
       .max_write = kMaxRecords,
       .bank = kRecords},
      {.name = "id",
       .item_bits = 8,
       .items = kObjects * kObjectCharacters,
       .max_read = kObjectCharacters,
       .max_write = 0,
       .bank = kObjectCharacters},
      {.name = "fifo",
       .item_bits = 16,
       .items = 65536 * kQueueItems,
       .max_read = kQueueItems,
       .max_write = 0,
       .bank = kQueueItems,
       .counted = true},
  }};
}

// "coil:3", "input:3" or "discrete-input:3", "holding:0x64", "input-register:100", "holding:100.5",
// and the references 00001, 10001, 30001, 40001 (or 000001 .. 465536), which count from 1;
// "file:4:7" (file, record), "file:4:7.3", "id:0" (object), "id:basic", "fifo:1246" (count of the
// queue), "fifo:1246:1" (its first register).
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at);

}  // namespace fieldcast::modbus

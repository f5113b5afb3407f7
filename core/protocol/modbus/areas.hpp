#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus {

enum class Table : AreaIndex { kCoil, kInput, kHolding, kInputRegister };

// Application Protocol V1.1b3, 6.1-6.12; they limit every PDU to 253 bytes.
inline constexpr std::uint16_t kMaxReadBits = 2000;
inline constexpr std::uint16_t kMaxWriteBits = 1968;
inline constexpr std::uint16_t kMaxReadRegisters = 125;
inline constexpr std::uint16_t kMaxWriteRegisters = 123;
inline constexpr std::uint16_t kMaxReadWriteRegisters = 121;  // written registers of function 23

// In the order of Table. `mask_write`: supports function 22, for one bit or byte of a register.
[[nodiscard]] constexpr std::array<Area, 4> areas(bool mask_write) {
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
       .byte_write = mask_write},
      {.name = "input-register", .item_bits = 16, .max_read = kMaxReadRegisters, .max_write = 0},
  }};
}

// "coil:3", "input:3" or "discrete-input:3", "holding:0x64", "input-register:100", "holding:100.5",
// and the references 00001, 10001, 30001, 40001 (or 000001 .. 465536), which count from 1.
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at);

}  // namespace fieldcast::modbus

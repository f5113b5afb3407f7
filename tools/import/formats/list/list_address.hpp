// Parses the address cell of a register list. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/points/address.hpp"

namespace fieldcast::importing {

// Possible meanings of a cell. "40001" may be a reference (holding register 0) or a plain number;
// the other rows decide. "4x0001" is only a reference, "100" only a number.
struct ListAddress {
  std::optional<Reference> reference;  // its area is known
  std::optional<std::uint32_t> plain;  // 0 to 65535
  std::optional<std::uint8_t> bit;
  unsigned registers = 0;   // "100-101" has 2; 0: a single number
  bool marked_hex = false;  // "0x10", "10h", "$10"

  // Five or six digits, the first of which may be the area.
  [[nodiscard]] bool is_open() const { return reference && plain; }
};

struct AddressNotation {
  bool hex = false;   // unmarked digits are hexadecimal
  unsigned base = 1;  // first number after the area digit
};

// "40101", "4x0101", "%MW100", "0x64", "100 (0x64)", "100-101", "100..103", "100 to 101", "100,
// 101", "30001/2", "40007 bit 3", "40007.3". The error is the reason.
[[nodiscard]] tl::expected<ListAddress, std::string> list_address_from(std::string_view cell,
                                                                       AddressNotation notation);

}  // namespace fieldcast::importing

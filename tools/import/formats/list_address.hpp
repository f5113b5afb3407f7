// The cell of a register list that says where a value is. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/import/address.hpp"

namespace fieldcast::importing {

// What one cell may mean. "40001" may be a reference (holding register 0) and a plain number: the
// other rows of the list tell. "4x0001" is a reference alone, "100" a number alone.
struct ListAddress {
  std::optional<Reference> reference;  // its area is known
  std::optional<std::uint32_t> plain;  // 0 to 65535
  std::optional<std::uint8_t> bit;
  unsigned registers = 0;   // "100-101" names 2; 0: one number alone
  bool marked_hex = false;  // "0x10", "10h", "$10"

  // Five or six digits of which the first one may be the area's.
  [[nodiscard]] bool is_open() const { return reference && plain; }
};

struct AddressNotation {
  bool hex = false;   // digits without a mark are hexadecimal
  unsigned base = 1;  // the first number behind the digit of an area
};

// "40101", "4x0101", "%MW100", "0x64", "100 (0x64)", "100-101", "100..103", "100 to 101",
// "100, 101", "30001/2", "40007 bit 3", "40007.3". Any other text in the cell is refused; the error
// says why.
[[nodiscard]] tl::expected<ListAddress, std::string> list_address_from(std::string_view cell,
                                                                       AddressNotation notation);

}  // namespace fieldcast::importing

// Whether a value of a type can lie at an address: one rule for the channels of a configuration and
// for commands to addresses. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/codec/value_codec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct FitFault {
  enum class About : std::uint8_t { kType, kPart };  // kPart: the bit or byte of an item
  About about = About::kType;
  std::string what;        // "type int32 has 32 bits, 'VW10' has 16"
  std::string allowed;     // "a type of 16 bits"
  std::string suggestion;  // a type or an address, or empty
};

// Nothing: it fits. `at` is the address as written; Encoding::bit holds the bit of the address, if
// it names one.
[[nodiscard]] std::optional<FitFault> check_fit(std::string_view at, const ParsedAddress& address,
                                                const Area& area, const Encoding& encoding);

// It names one value of a declared record; those beside it have other widths.
[[nodiscard]] constexpr bool is_field(const ParsedAddress& address) {
  return address.value_bits != 0 || address.text_characters != 0;
}

// "byte: low, byte: high" or "byte: 0 to 3": how the bytes of an item are named.
[[nodiscard]] std::string byte_names(unsigned item_bits);

// Nothing: a byte of an item of this area can be written without touching the rest of the item;
// else why not; `at` stands in it as it is. Reading the item first and writing it whole would undo
// what the device itself writes in between.
[[nodiscard]] std::optional<std::string> why_no_byte_write(std::string_view at, const Area& area);

}  // namespace fieldcast

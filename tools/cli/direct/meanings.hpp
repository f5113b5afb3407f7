// Calculates consecutive addresses in the PLC's notation. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/value.hpp"
#include "core/codec/value_codec.hpp"
#include "core/protocol/protocol.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// "holding:102" for "holding:100" and 2. Empty at the end of the area, or if the notation counts
// differently (bits of a word, octal numbers).
[[nodiscard]] std::optional<std::string> address_behind(const Protocol& protocol,
                                                        std::string_view at, std::uint32_t items);

[[nodiscard]] std::uint32_t values_in_request(const Protocol& protocol, const ParsedAddress& at,
                                              std::uint32_t value_items);

// Decodes items in every type and order, to find the type of a displayed value. Pure functions.
struct Meaning {
  std::string name;  // "float32", "float32 word-swapped"
  Encoding encoding;
};

// Parses "float32,int32" or "all"; each type with all its orders.
[[nodiscard]] tl::expected<std::vector<Meaning>, std::string> meanings_of(std::string_view types);

// For each item its address and bytes, then the value that starts there for each meaning: "-" if
// invalid, blank at the end of the items. REQUIRES: `image` has whole items of 8 or 16 item_bits.
[[nodiscard]] std::vector<std::string> meaning_lines(std::span<const std::string> addresses,
                                                     unsigned item_bits, ByteView image,
                                                     std::span<const Meaning> meanings,
                                                     const Screen& screen);

}  // namespace fieldcast::cli

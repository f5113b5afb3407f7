// Decodes items in every type and order, so that the user can find the type that matches the
// device's display. Pure functions.
#pragma once

#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/value.hpp"
#include "core/codec/value_codec.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// A type with its word and byte order.
struct Meaning {
  std::string name;  // "float32", "float32 word-swapped"
  Encoding encoding;
};

// Parses "float32,int32" or "all"; each type with all its orders. The error is one line.
[[nodiscard]] tl::expected<std::vector<Meaning>, std::string> meanings_of(std::string_view types);

// Returns one line for each item: its address and bytes, then the value that starts there for each
// meaning. "-" if the value is invalid, blank if the items end too early. REQUIRES: `image` has
// whole items of item_bits, 8 or 16 (protocol.hpp).
[[nodiscard]] std::vector<std::string> meaning_lines(std::span<const std::string> addresses,
                                                     unsigned item_bits, ByteView image,
                                                     std::span<const Meaning> meanings,
                                                     const Screen& screen);

}  // namespace fieldcast::cli

// What the items of a device mean in every type and order: for those who know the value on the
// display of the device, and look for its type. Pure functions.
#pragma once

#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/value.hpp"
#include "core/codec/value_codec.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// One reading of items: a type, and in which order its words and bytes stand.
struct Meaning {
  std::string name;  // "float32", "float32 word-swapped"
  Encoding encoding;
};

// "float32,int32", or "all": each type with its orders, as far as it has any. The error is one
// line.
[[nodiscard]] tl::expected<std::vector<Meaning>, std::string> meanings_of(std::string_view types);

// For each item a line with its address and bytes, then what begins there by each meaning; "-"
// where it is no value of the type, nothing where the items end too soon. REQUIRES: `image` is
// whole items of item_bits, 8 or 16 (protocol.hpp).
[[nodiscard]] std::vector<std::string> meaning_lines(std::span<const std::string> addresses,
                                                     unsigned item_bits, ByteView image,
                                                     std::span<const Meaning> meanings,
                                                     const Screen& screen);

}  // namespace fieldcast::cli

// LZW over nibbles, implemented from its description with dictionaries of strings, slow and
// independent of core/codec/lzw. Tests and the benchmark compare the codec with it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

[[nodiscard]] std::vector<unsigned> reference_codes(ByteView original);

// Packs codes into bits; the k-th has bit_length(min(15 + k, 4095)) bits; padded to a byte.
[[nodiscard]] Bytes packed(const std::vector<unsigned>& codes);

// Returns `std::nullopt` for a missing or undefined code, or a string beyond `length`.
[[nodiscard]] std::optional<Bytes> reference_decode(ByteView bytes, std::size_t length);

}  // namespace fieldcast::test

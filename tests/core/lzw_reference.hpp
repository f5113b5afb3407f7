// LZW over nibbles as its description says it, with dictionaries of strings: slow, plain and
// written apart from core/codec/lzw. What the codec is compared with, in tests and in the bench.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

// The codes of the nibbles of `original`.
[[nodiscard]] std::vector<unsigned> reference_codes(ByteView original);

// Codes as bits, the k-th of bit_length(min(15 + k, 4095)), filled to a byte.
[[nodiscard]] Bytes packed(const std::vector<unsigned>& codes);

// Nothing: the codes end early, or one is not defined, or a string is longer than what is missing.
[[nodiscard]] std::optional<Bytes> reference_decode(ByteView bytes, std::size_t length);

}  // namespace fieldcast::test

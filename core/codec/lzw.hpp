// LZW over nibbles: the compression of DTC packets.
//
//     input        nibbles of the bytes, the high one first
//     dictionary   0..15: the single nibbles. Each code adds one entry, string + next nibble, up to
//                  4096 entries; then the dictionary does not change
//     code k       bit_width(min(15 + k, 4095)) bits, most significant first; k counts from 0. The
//                  last byte is filled with zeros
//
// The encoder's dictionary is a trie in one flat array, sixteen children per string. A node is
// cleared when it is created: the time depends on the input only, and there is no allocation. The
// decoder stores no strings: the output already contains each entry, at its predecessor, one nibble
// longer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"

namespace fieldcast {

inline constexpr std::size_t kLzwEntries = 4096;
inline constexpr std::size_t kLzwMaxOriginal = 4096;  // limit of the decoder, in bytes

// Owns 128 KiB of dictionary, reset by each call; use one per thread.
class LzwEncoder {
 public:
  LzwEncoder() : children_(std::make_unique_for_overwrite<Trie>()) {}

  // Returns the number of bytes, or empty if `out` is too small. Does not allocate.
  [[nodiscard]] std::optional<std::size_t> encode(ByteView original, std::span<std::uint8_t> out);

 private:
  using Trie = std::array<std::array<std::uint16_t, 16>,
                          kLzwEntries>;  // 0: no such child (code 0 is never a child)
  std::unique_ptr<Trie> children_;
};

enum class LzwFault : std::uint8_t {
  kTooLong,    // the original is longer than kLzwMaxOriginal
  kTruncated,  // the codes end before the original
  kCode,       // an undefined code
  kOverrun,    // a string beyond the end of the original
  kTail,       // more bytes than codes, or filled with bits other than zeros
};
[[nodiscard]] std::string_view to_text(LzwFault fault);

// On a fault `out` is unchanged. `length` limits time and memory for any codes.
[[nodiscard]] tl::expected<void, LzwFault> lzw_decode(ByteView codes, std::size_t length,
                                                      Bytes& out);

}  // namespace fieldcast

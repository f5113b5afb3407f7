// LZW over nibbles: the compression of DTC packets.
//
//     input        nibbles of the bytes, the high one first
//     dictionary   0..15: the single nibbles. Each code adds one entry, string + next nibble, up to
//                  4096 entries; then the dictionary stays as it is
//     code k       bit_width(min(15 + k, 4095)) bits, most significant first; k counts from 0. The
//                  last byte is filled with zeros
//
// The encoder's dictionary is a trie in one flat array, sixteen children for each string. A node is
// cleared when it is made: a call costs as much as its input is long, and nothing is allocated. The
// decoder needs no strings: each entry stands in the output already, where its predecessor was
// written, one nibble longer.
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
inline constexpr std::size_t kLzwMaxOriginal = 4096;  // bytes that a decoder is ready to give back

// Owns 128 KiB of dictionary, used anew by each call: one for each thread that compresses.
class LzwEncoder {
 public:
  LzwEncoder() : children_(std::make_unique_for_overwrite<Trie>()) {}

  // Writes the codes of `original`, of any length, to the beginning of `out`: the number of bytes,
  // or nothing when they need more than `out` has. Allocates nothing.
  [[nodiscard]] std::optional<std::size_t> encode(ByteView original, std::span<std::uint8_t> out);

 private:
  using Trie = std::array<std::array<std::uint16_t, 16>,
                          kLzwEntries>;  // 0: no such child (code 0 is never a child)
  std::unique_ptr<Trie> children_;
};

enum class LzwFault : std::uint8_t {
  kTooLong,    // the original would be longer than kLzwMaxOriginal
  kTruncated,  // the codes end before the original does
  kCode,       // a code that is not yet defined
  kOverrun,    // a string that goes beyond the original's end
  kTail,       // more bytes than codes, or filled with other than zeros
};
[[nodiscard]] std::string_view to_text(LzwFault fault);

// Appends the original of exactly `length` bytes to `out`; on a fault `out` is as before. Time and
// memory are bounded by `length`, whatever the codes say.
[[nodiscard]] tl::expected<void, LzwFault> lzw_decode(ByteView codes, std::size_t length,
                                                      Bytes& out);

}  // namespace fieldcast

// What protocols share that search a response in received bytes and convert its bits.
#pragma once

#include <algorithm>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"

namespace fieldcast {

// Spurious character of an RS-485 driver that changes its direction.
[[nodiscard]] constexpr bool is_turnaround(std::uint8_t byte) {
  return byte == 0x00 || byte == 0xFF;
}

// The cause if nothing better is found in the bytes.
[[nodiscard]] inline Cause cause_of_noise(ByteView bytes) {
  return std::ranges::all_of(bytes, is_turnaround) ? Cause::kNoResponse : Cause::kMalformed;
}

// Findings of a search that has not found the response.
struct SearchFaults {
  bool truncated = false;  // an incomplete frame of the polled device
  bool cut = false;        // as `truncated`, but within noise
  bool mismatch = false, foreign = false, broken = false;
  std::size_t noise = 0;  // bytes

  // The most specific cause for the polled device.
  [[nodiscard]] Cause cause() const {
    if (mismatch) return Cause::kMalformed;
    if (truncated) return Cause::kTruncated;
    if (broken) return Cause::kChecksum;
    if (cut) return Cause::kTruncated;
    if (foreign) return Cause::kForeign;
    return noise > 0 ? Cause::kMalformed : Cause::kNoResponse;
  }
};

// Packs bits of one byte each into eight per byte, from the least significant; unused bits are 0.
inline void append_bits(Bytes& out, ByteView bits) {
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (i % 8 == 0) out.push_back(0);
    out.back() = static_cast<std::uint8_t>(out.back() | (bits[i] != 0 ? 1u : 0u) << i % 8);
  }
}
// The opposite, from bit `first` on.
[[nodiscard]] inline Bytes unpack_bits(ByteView packed, std::size_t count, std::size_t first = 0) {
  Bytes bits(count);
  for (std::size_t i = 0; i < count; ++i)
    bits[i] = static_cast<std::uint8_t>(packed[(first + i) / 8] >> (first + i) % 8 & 1u);
  return bits;
}

}  // namespace fieldcast

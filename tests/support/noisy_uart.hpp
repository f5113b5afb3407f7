// A serial line with random bit errors, 8N1, down to start and stop bits: what a receiver's UART
// makes of a transmission.
//
// Errors are independent and of one rate. A UART that finds a low bit takes the eight behind it as
// a character and the tenth as its stop bit. A low stop bit is taken as the next start bit
// (National Semiconductor PC16550D, line status register, bit 3), and the character is handed over
// all the same, as Linux does without INPCK; only a break (all bits low) is dropped.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

inline constexpr std::size_t kBitsOfCharacter = 10;  // 8N1

// The levels of `characters` sent back to back, and of the resting line before and behind, one
// character each.
[[nodiscard]] std::vector<bool> line_levels(ByteView characters);
// The characters that a UART finds in those levels; behind them the line rests.
[[nodiscard]] Bytes uart_received(const std::vector<bool>& levels);

class NoisyUart {
 public:
  NoisyUart(double bit_error_rate, std::uint64_t seed) : rate_(bit_error_rate), random_(seed) {
    draw();
  }
  [[nodiscard]] Bytes pass(ByteView characters);
  [[nodiscard]] std::uint64_t flipped() const { return flipped_; }

 private:
  void draw();
  const double rate_;
  std::mt19937_64 random_;
  std::uint64_t good_ = 0;  // bits before the next flipped one
  std::uint64_t flipped_ = 0;
};

}  // namespace fieldcast::test

// Simulates a serial line with random bit errors, 8N1, down to start and stop bits, as seen by the
// receiver's UART.
//
// Errors are independent with a constant rate. A low bit starts a character of eight bits, followed
// by the stop bit. A low stop bit is used as the next start bit (National Semiconductor PC16550D,
// line status register, bit 3). The character is still delivered, as Linux does without INPCK; only
// a break (all bits low) is dropped.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

inline constexpr std::size_t kBitsOfCharacter = 10;

// Returns the levels of `characters` sent back to back, with one idle character before and after.
[[nodiscard]] std::vector<bool> line_levels(ByteView characters);
// Returns the characters that a UART receives from these levels, followed by an idle line.
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

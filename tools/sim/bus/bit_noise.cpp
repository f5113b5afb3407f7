#include <cmath>

#include "tools/sim/bus/wire.hpp"

namespace fieldcast::sim {

BitNoise::BitNoise(double rate, unsigned bits_per_character, std::uint64_t seed)
    : rate_(rate), bits_(bits_per_character), random_(seed) {
  draw();
}

void BitNoise::draw() {
  if (rate_ <= 0) return;
  // The number of good bits is geometrically distributed; 1e15 bits exceed any run.
  const double gap = rate_ >= 1
                         ? 0
                         : std::floor(std::log1p(-std::generate_canonical<double, 53>(random_)) /
                                      std::log1p(-rate_));
  bits_left_ = static_cast<std::uint64_t>(std::min(gap, 1e15));
}

std::uint8_t BitNoise::pass(std::uint8_t character) {
  if (rate_ <= 0) return character;
  unsigned used = 0;
  while (bits_left_ < bits_ - used) {
    used += static_cast<unsigned>(bits_left_) + 1;
    // Bits 1..8 are data. A flipped start, parity or stop bit usually gives a wrong character.
    character =
        static_cast<std::uint8_t>(character ^ (used >= 2 && used <= 9 ? 1u << (used - 2) : 0x55u));
    draw();
  }
  bits_left_ -= bits_ - used;
  return character;
}

std::uint8_t BitNoise::garble(std::uint8_t character) {
  return static_cast<std::uint8_t>(character ^ (1 + random_() % 255));
}

}  // namespace fieldcast::sim

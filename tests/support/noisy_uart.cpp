#include "tests/support/noisy_uart.hpp"

#include <cmath>

namespace fieldcast::test {

std::vector<bool> line_levels(ByteView characters) {
  std::vector<bool> levels(kBitsOfCharacter, true);
  for (const std::uint8_t character : characters) {
    levels.push_back(false);
    for (unsigned bit = 0; bit < 8; ++bit) levels.push_back((character >> bit & 1u) != 0);
    levels.push_back(true);
  }
  levels.resize(levels.size() + kBitsOfCharacter, true);
  return levels;
}

Bytes uart_received(const std::vector<bool>& levels) {
  const auto level = [&](std::size_t at) { return at >= levels.size() || levels[at]; };
  Bytes received;
  for (std::size_t at = 0; at < levels.size();) {
    if (level(at)) {
      ++at;
      continue;
    }
    unsigned character = 0;
    for (unsigned bit = 0; bit < 8; ++bit) character |= (level(at + 1 + bit) ? 1u : 0u) << bit;
    const bool stopped = level(at + 9);
    if (stopped || character != 0) received.push_back(static_cast<std::uint8_t>(character));
    at += stopped ? kBitsOfCharacter : kBitsOfCharacter - 1;
  }
  return received;
}

void NoisyUart::draw() {
  if (rate_ <= 0) {
    good_ = UINT64_MAX;
    return;
  }
  // The number of good bits before a flipped one is geometrically distributed.
  const double run =
      std::floor(std::log1p(-std::generate_canonical<double, 53>(random_)) / std::log1p(-rate_));
  good_ = static_cast<std::uint64_t>(std::min(run, 1e15));
}

Bytes NoisyUart::pass(ByteView characters) {
  const std::uint64_t bits = (characters.size() + 2) * kBitsOfCharacter;
  if (rate_ <= 0 || good_ >= bits) {
    if (rate_ > 0) good_ -= bits;
    return {characters.begin(), characters.end()};
  }
  std::vector<bool> levels = line_levels(characters);
  std::uint64_t at = 0;
  for (; at + good_ < bits; draw()) {
    at += good_;
    levels[at].flip();
    ++at;
    ++flipped_;
  }
  good_ -= bits - at;
  return uart_received(levels);
}

}  // namespace fieldcast::test

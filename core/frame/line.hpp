// The serial line in the cost model: duration of characters, and silences between frames.
#pragma once

#include <cstdint>
#include <variant>

#include "core/base/time.hpp"

namespace fieldcast {

enum class Parity : std::uint8_t { kNone, kEven, kOdd };

struct LineFormat {
  std::uint32_t baud = 19200;
  std::uint8_t data_bits = 8;  // 7 or 8
  Parity parity = Parity::kEven;
  std::uint8_t stop_bits = 1;  // 1 or 2

  // Start bit, data, parity, stop: 8E1 is 11.
  [[nodiscard]] constexpr unsigned bits_per_character() const {
    return 1u + data_bits + (parity == Parity::kNone ? 0u : 1u) + stop_bits;
  }
  [[nodiscard]] constexpr Duration characters(double count) const {
    return Duration{static_cast<std::int64_t>(count * bits_per_character() * 1e9 / baud + 0.5)};
  }
  friend bool operator==(const LineFormat&, const LineFormat&) = default;
};

// Silence between a response and the next request: 3.5 characters of 11 bits up to 19200 baud,
// 1.750 ms above (Modbus over Serial Line V1.02, 2.5.1.1).
struct StandardSilence {
  friend bool operator==(StandardSilence, StandardSilence) = default;
};
struct CharacterSilence {
  double characters = 3.5;
  friend bool operator==(CharacterSilence, CharacterSilence) = default;
};
// The standard in plans; the bus learns how much shorter it may be, down to `least`.
struct LearnedSilence {
  Duration least{};  // zero: as the line permits, see least_silence()
  friend bool operator==(LearnedSilence, LearnedSilence) = default;
};
using SilenceRule = std::variant<StandardSilence, CharacterSilence, Duration, LearnedSilence>;

// 1.5 characters, which the standard permits inside a frame, and at least 0.3 ms for adapters.
[[nodiscard]] Duration least_silence(const LearnedSilence& rule, const LineFormat& line);
[[nodiscard]] Duration silence_of(const SilenceRule& rule, const LineFormat& line);

}  // namespace fieldcast

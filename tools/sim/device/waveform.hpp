// What the plant does while nobody commands it: a value over time for each channel, and its items
// in 16-bit registers. The encoding is written apart from the bridge's codec, so that a misreading
// cannot pass on both ends. Pure functions of time and seed.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::sim {

enum class Shape : std::uint8_t { kSine, kRamp, kCounter, kWalk, kSquare, kConstant };

struct Waveform {
  Shape shape = Shape::kSine;
  double low = 0, high = 1000;  // of the raw number, before exponent, scale and offset
  Duration period = std::chrono::seconds{10};
  std::uint64_t seed = 1;
  // The raw number at a time since the plant's start; within low .. high.
  [[nodiscard]] double at(Duration since_start) const;
};

// A shape that suits the channel's type and limits; the same seed gives the same plant.
[[nodiscard]] Waveform waveform_for(const ChannelSpec& channel, std::uint64_t seed);

// The decimal exponent in every register that a channel's `exponent-from` names: constant, so that
// channels may share it.
inline constexpr int kSimulatedExponent = -1;
[[nodiscard]] Waveform exponent_waveform();
[[nodiscard]] Encoding exponent_encoding(const ChannelSpec& channel);

// Registers that a value of this encoding takes.
[[nodiscard]] std::uint32_t waveform_registers(const Encoding& encoding);

// Its bits: 1 for bool, 8 for the types of one byte, 8 * n for string(n).
[[nodiscard]] std::uint32_t waveform_bits(const Encoding& encoding);

// The value's registers at a time; for bool one item of 0 or 1, for a byte its bits in the low
// half.
[[nodiscard]] std::vector<std::uint16_t> waveform_items(const Waveform& waveform,
                                                        const Encoding& encoding,
                                                        Duration since_start);

// A good, cheap mixing of bits (splitmix64, Steele et al. 2014): seeds of parts from the seed of
// the whole.
[[nodiscard]] std::uint64_t mix(std::uint64_t seed, std::uint64_t salt);
[[nodiscard]] std::uint64_t mix(std::uint64_t seed, std::string_view salt);

}  // namespace fieldcast::sim

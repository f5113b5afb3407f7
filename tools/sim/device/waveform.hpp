// Generates the simulated value of each channel as a function of time and seed. The encoder is
// independent of the bridge's codec, so that an error cannot cancel out. Pure functions.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/channel_spec.hpp"

namespace fieldcast::sim {

enum class Shape : std::uint8_t { kSine, kRamp, kCounter, kWalk, kSquare, kConstant };

struct Waveform {
  Shape shape = Shape::kSine;
  double low = 0, high = 1000;  // raw number, before scale and offset
  Duration period = std::chrono::seconds{10};
  std::uint64_t seed = 1;
  [[nodiscard]] double at(Duration since_start) const;
};

[[nodiscard]] Waveform waveform_for(const ChannelSpec& channel, std::uint64_t seed);

// Decimal exponent in every register of an `exponent-from`; constant, so that channels can share
// it.
inline constexpr int kSimulatedExponent = -1;
[[nodiscard]] Waveform exponent_waveform();
[[nodiscard]] Encoding exponent_encoding(const ChannelSpec& channel);

[[nodiscard]] std::uint32_t waveform_registers(const Encoding& encoding);

// Number of bits: 1 for bool, 8 for one-byte types, 8 * n for string(n).
[[nodiscard]] std::uint32_t waveform_bits(const Encoding& encoding);

// For bool one item of 0 or 1, for a byte its bits in the low half.
[[nodiscard]] std::vector<std::uint16_t> waveform_items(const Waveform& waveform,
                                                        const Encoding& encoding,
                                                        Duration since_start);

// Derives the seed of a part from the seed of the whole (splitmix64, Steele et al. 2014).
[[nodiscard]] std::uint64_t mix(std::uint64_t seed, std::uint64_t salt);
[[nodiscard]] std::uint64_t mix(std::uint64_t seed, std::string_view salt);

}  // namespace fieldcast::sim

#include "core/model/channel_spec.hpp"

#include <algorithm>
#include <cmath>

namespace fieldcast {
namespace {

// Decimals that a number needs; at most `most`, to which it is rounded then.
int decimals_of(double number, int most) {
  double power = 1;
  for (int decimals = 0; decimals < most; ++decimals, power *= 10) {
    const double shifted = std::abs(number) * power;
    if (std::abs(shifted - std::round(shifted)) <= 1e-9 * shifted) return decimals;
  }
  return most;
}

// Decimals with which two neighbours of a grid of this step differ: 0.1 has 1, 0.0977 has 3.
int decimals_of_step(double step) {
  const int leading = std::max(0, static_cast<int>(std::ceil(-std::log10(std::abs(step)))));
  return decimals_of(step, leading + 1);
}

}  // namespace

std::optional<ShownDigits> shown_digits(const ChannelSpec& channel) {
  if (channel.digits) return ShownDigits{*channel.digits, true};
  const Encoding& encoding = channel.encoding;
  const bool is_number = encoding.type != ValueType::kBool && encoding.type != ValueType::kString;
  const bool is_float =
      encoding.type == ValueType::kFloat32 || encoding.type == ValueType::kFloat64;
  const int written = encoding.text_number.decimals;
  if (!is_number || encoding.exponent_distance != 0 || encoding.scale == 0 ||
      (is_float && written < 0))
    return std::nullopt;
  const int scaled = decimals_of_step(encoding.scale * std::pow(10, -std::max(0, written)));
  const int all = std::max(scaled, decimals_of(encoding.offset, scaled + 2));
  if (all > kMostDigits) return std::nullopt;
  return ShownDigits{static_cast<std::uint8_t>(all), false};
}

}  // namespace fieldcast

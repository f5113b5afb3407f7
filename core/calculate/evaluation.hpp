// The result of one calculated channel from the states of its inputs. Pure.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/calculation.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

struct InputState {
  double value = 0;  // a bool is 0 or 1
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Instant acquired = kLongAgo;
  friend bool operator==(const InputState&, const InputState&) = default;
};
// REQUIRES: the value is not a text.
[[nodiscard]] InputState state_of(const Sample& sample);

struct Calculated {
  Value value;  // only if the quality is kGood
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Instant acquired = kLongAgo;  // of the oldest input
};

// The rank of a quality: 0 for kGood, higher for a worse one. No two have the same.
[[nodiscard]] int badness(Quality quality);

// The cause of a sample that is not good, for counters. REQUIRES: not kGood.
[[nodiscard]] Cause cause_of(const Calculated& result);

// `type`: kBool or kFloat64. Calls the formula only if all inputs are good.
[[nodiscard]] Calculated evaluate(const Formula& formula, std::span<const InputState> inputs,
                                  ValueType type);

}  // namespace fieldcast

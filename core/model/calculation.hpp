// How the value of a calculated channel follows from other channels. Plain values; the loader makes
// them. The formula itself comes from outside, because core contains no parser of expressions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {

// The result for the values of the inputs, in their order; NaN or infinite if there is none. Not
// thread-safe.
using Formula = std::function<double(std::span<const double>)>;

struct Calculation {
  std::string expression;           // as written
  std::vector<ChannelPath> inputs;  // in the order of the formula's arguments
  std::string remark;               // one line for the log, for example about units; or empty
  std::function<Formula()> compile{};
  friend bool operator==(const Calculation& a, const Calculation& b) {
    return a.expression == b.expression && a.inputs == b.inputs;
  }
};

struct SharedCalculation {
  std::shared_ptr<const Calculation> value;
  explicit operator bool() const { return value != nullptr; }
  friend bool operator==(const SharedCalculation& a, const SharedCalculation& b) {
    return a.value == b.value || (a.value && b.value && *a.value == *b.value);
  }
};

// State of an input that belongs to another bus. `input`: its index in foreign_inputs().
struct InputSample {
  std::size_t input = 0;
  double value = 0;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Instant acquired = kLongAgo;
};

}  // namespace fieldcast

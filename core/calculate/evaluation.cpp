#include "core/calculate/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fieldcast {

InputState state_of(const Sample& sample) {
  const bool* flag = std::get_if<bool>(&sample.value);
  const double value = flag != nullptr ? (*flag ? 1 : 0) : as_number(sample.value).value_or(0);
  return {value, sample.quality, sample.device_code, sample.acquired};
}

int badness(Quality quality) {
  switch (quality) {
    case Quality::kGood: return 0;
    case Quality::kUncertain: return 1;
    case Quality::kNotYetRead: return 2;
    case Quality::kBadRange: return 3;
    case Quality::kBadFrame: return 4;
    case Quality::kBadDeviceError: return 5;
    case Quality::kBadNoResponse: return 6;
    case Quality::kBadConfiguration: return 7;
  }
  return 8;
}

Cause cause_of(const Calculated& result) {
  switch (result.quality) {
    case Quality::kBadNoResponse: return Cause::kNoResponse;
    case Quality::kBadFrame: return Cause::kMalformed;
    case Quality::kBadDeviceError: return Cause::kDeviceError;
    case Quality::kBadRange: return Cause::kRange;
    case Quality::kBadConfiguration: return Cause::kBadAddress;
    default: return Cause::kLate;
  }
}

Calculated evaluate(const Formula& formula, std::span<const InputState> inputs, ValueType type) {
  Calculated result{.quality = Quality::kGood, .acquired = kNever};
  std::vector<double> values;
  values.reserve(inputs.size());
  for (const InputState& input : inputs) {
    if (badness(input.quality) > badness(result.quality)) {
      result.quality = input.quality;
      result.device_code = input.device_code;
    }
    result.acquired = std::min(result.acquired, input.acquired);
    values.push_back(input.value);
  }
  if (result.quality != Quality::kGood) return result;
  const double number = formula(values);
  if (!std::isfinite(number)) {
    result.quality = Quality::kBadRange;
    result.device_code = kNoResultCode;
  } else if (type == ValueType::kBool) {
    result.value = number != 0;
  } else {
    result.value = number;
  }
  return result;
}

}  // namespace fieldcast

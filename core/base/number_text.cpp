#include "core/base/number_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace fieldcast {
namespace {

template <typename Number>
std::string shortest(Number number) {
  if (std::isnan(number)) return "nan";  // regardless of its sign bit
  constexpr Number kLeast = static_cast<Number>(1e-4), kMost = static_cast<Number>(1e16);
  const Number magnitude = std::abs(number);
  const bool plain = magnitude == 0 || (magnitude >= kLeast && magnitude < kMost);
  std::array<char, 32> buffer{};  // sign, 17 digits, point, exponent; or four zeros and a point
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                 plain ? std::chars_format::fixed : std::chars_format::scientific)
                       .ptr;
  return {buffer.data(), end};
}

}  // namespace

std::string number_text(double number) { return shortest(number); }

std::string float32_text(double number) {
  const bool in_range = !(std::abs(number) > std::numeric_limits<float>::max());
  const float single = in_range ? static_cast<float>(number) : 0.0F;
  return static_cast<double>(single) == number ? shortest(single) : shortest(number);
}

}  // namespace fieldcast

// Floating-point numbers as text, in one way everywhere: the fewest digits that read back as the
// same number, without an exponent from 0.0001 to 1e16. Pure functions.
#pragma once

#include <string>

namespace fieldcast {

// "0.1", "25", "-2.5e-07", "nan", "inf", "-inf".
[[nodiscard]] std::string number_text(double number);

// Of a float32 channel, whose value travels as a double: "0.1" for 0.1f. What is no float (because
// of a scale) is spelt as the double that it is.
[[nodiscard]] std::string float32_text(double number);

}  // namespace fieldcast

// Floating-point numbers as text: the fewest digits that parse to the same number, without an
// exponent from 0.0001 to 1e16. Pure functions.
#pragma once

#include <string>

namespace fieldcast {

// "0.1", "25", "-2.5e-07", "nan", "inf", "-inf".
[[nodiscard]] std::string number_text(double number);

// For a float32 stored as a double: "0.1" for 0.1f. Other doubles are written as such.
[[nodiscard]] std::string float32_text(double number);

}  // namespace fieldcast

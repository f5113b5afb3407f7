#pragma once

#include "core/base/time.hpp"

namespace fieldcast::test {

constexpr UtcTime since_1970(std::int64_t second) { return {second * 1'000'000'000}; }
// Returns this many seconds after 2023-11-14T22:00:00Z.
constexpr UtcTime at_second(std::int64_t second) { return since_1970(1'699'999'200 + second); }

}  // namespace fieldcast::test

#pragma once

#include <algorithm>
#include <cstdio>
#include <vector>

namespace fieldcast::bench {

// The q-quantile (0..1) of the values; 0 if there are none.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

inline void print_figure(const char* what, double value, const char* unit, const char* goal) {
  std::printf("%-58s %12.4g %-10s %s\n", what, value, unit, goal);
  std::fflush(stdout);
}

}  // namespace fieldcast::bench

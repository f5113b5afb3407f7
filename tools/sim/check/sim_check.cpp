#include "tools/sim/check/sim_check.hpp"

#include <array>

namespace fieldcast::sim {

CheckRows sim_check(const Subject& subject, const std::function<void(double share)>& on_share) {
  constexpr std::array kParts{check_values, check_notation, check_answers, check_troubles,
                              check_late};
  CheckRows rows;
  for (std::size_t i = 0; i < kParts.size(); ++i) {
    kParts[i](subject, rows);
    if (on_share) on_share(static_cast<double>(i + 1) / kParts.size());
  }
  for (CheckRow& row : rows) row.variant = subject.variant;
  return rows;
}

}  // namespace fieldcast::sim

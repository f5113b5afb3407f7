#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {

CheckRows sim_check(const Subject& subject) {
  CheckRows rows;
  check_values(subject, rows);
  check_notation(subject, rows);
  check_answers(subject, rows);
  check_troubles(subject, rows);
  check_late(subject, rows);
  for (CheckRow& row : rows) row.variant = subject.variant;
  return rows;
}

}  // namespace fieldcast::sim

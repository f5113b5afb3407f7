// Tests the master of a protocol against its simulated device in virtual time.
#pragma once

#include <functional>

#include "tools/sim/check/check_report.hpp"
#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

// Deterministic; lasts some seconds at most. `on_share` receives the finished share, 0..1.
[[nodiscard]] CheckRows sim_check(const Subject& subject,
                                  const std::function<void(double share)>& on_share = {});

// Parts of sim_check(); each appends to `rows`.
void check_values(const Subject& subject, CheckRows& rows);
void check_notation(const Subject& subject, CheckRows& rows);
// Splits, truncations, flipped bits, leading noise.
void check_answers(const Subject& subject, CheckRows& rows);
void check_troubles(const Subject& subject, CheckRows& rows);
void check_late(const Subject& subject, CheckRows& rows);

}  // namespace fieldcast::sim

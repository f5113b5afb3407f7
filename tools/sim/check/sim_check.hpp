// The whole matrix of a protocol: its master against its simulated device, in virtual time.
#pragma once

#include <functional>

#include "tools/sim/check/check_report.hpp"
#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

// Every check of one subject. Deterministic; some seconds at most. `on_share` is told how much of
// it is done, of 1.
[[nodiscard]] CheckRows sim_check(const Subject& subject,
                                  const std::function<void(double share)>& on_share = {});

// Its parts. `rows` come behind those that are there.
// Every area and type: written, read and read back.
void check_values(const Subject& subject, CheckRows& rows);
// Every form of an address means the same items on both ends.
void check_notation(const Subject& subject, CheckRows& rows);
// Splits, truncations, flipped bits, noise before.
void check_answers(const Subject& subject, CheckRows& rows);
// Refusals, silence, wrong station.
void check_troubles(const Subject& subject, CheckRows& rows);
// Late answers, with the whole engine.
void check_late(const Subject& subject, CheckRows& rows);

}  // namespace fieldcast::sim

// The whole matrix of a protocol: its master against its simulated device, in virtual time.
#pragma once

#include "tools/sim/check/check_report.hpp"
#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

// Every check of one subject. Deterministic; some seconds at most.
[[nodiscard]] CheckRows sim_check(const Subject& subject);

// Its parts. `rows` come behind those that are there.
void check_values(const Subject& subject,
                  CheckRows& rows);  // every area and type, written, read and read back
void check_notation(const Subject& subject,
                    CheckRows& rows);  // every form of an address means one place on both ends
void check_answers(const Subject& subject,
                   CheckRows& rows);  // splits, truncations, flipped bits, noise before
void check_troubles(const Subject& subject, CheckRows& rows);  // refusals, silence, wrong station
void check_late(const Subject& subject, CheckRows& rows);  // late answers, with the whole engine

}  // namespace fieldcast::sim

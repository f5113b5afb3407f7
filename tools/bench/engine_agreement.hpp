// Compares the whole engine with its plan in virtual time, for schedule_bench.
#pragma once

#include <cstdint>

namespace fieldcast::bench {

// Random maps at several response times: the result of `fieldcast plan` and of `--simulate`.
void print_agreement(std::uint64_t first_seed, unsigned maps);

// The sustained load of the whole engine, compared with the scheduler's, on maps not used for
// tuning.
void print_engine(std::uint64_t first_seed, unsigned maps);

}  // namespace fieldcast::bench

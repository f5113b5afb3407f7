// Compares the engine with its plan in virtual time, for schedule_bench.
#pragma once

#include <cstdint>

namespace fieldcast::bench {

// Random maps: `fieldcast plan` and `--simulate` must agree.
void print_agreement(std::uint64_t first_seed, unsigned maps);

// The sustained load of engine and scheduler, on maps not used for tuning.
void print_engine(std::uint64_t first_seed, unsigned maps);

}  // namespace fieldcast::bench

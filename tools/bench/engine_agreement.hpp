// The whole engine against its plan, in virtual time: for schedule_bench.
#pragma once

#include <cstdint>

namespace fieldcast::bench {

// Random maps at several answer times: what `fieldcast plan` says, and what `--simulate` then sees.
void print_agreement(std::uint64_t first_seed, unsigned maps);

// The load that the whole engine sustains on maps that nothing was tuned on, beside the
// scheduler's.
void print_engine(std::uint64_t first_seed, unsigned maps);

}  // namespace fieldcast::bench

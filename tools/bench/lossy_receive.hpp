// Datagrams that never arrive, for benches and tests (lossy_receive.cpp). Any thread.
#pragma once

#include <cstdint>

namespace fieldcast::bench {

// From now on this share of the received datagrams is lost: 0.05 is one in twenty.
void lose(double share);

// One datagram is lost: the one that is received after so many others from now on. Negative: none.
void lose_one(std::int64_t after);

// Those that were lost since the process began.
[[nodiscard]] std::uint64_t lost_datagrams();

}  // namespace fieldcast::bench

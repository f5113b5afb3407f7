#pragma once

#include <cstdint>

namespace fieldcast::bench {

// Drops this share of the received datagrams from now on: 0.05 is one in twenty.
void lose(double share);

// Drops one datagram after this many others. Negative: none.
void lose_one(std::int64_t after);

[[nodiscard]] std::uint64_t lost_datagrams();

}  // namespace fieldcast::bench

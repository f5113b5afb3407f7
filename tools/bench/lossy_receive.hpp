// Datagrams that never arrive, for benches (lossy_receive.cpp).
#pragma once

namespace fieldcast::bench {

// From now on this share of the received datagrams is lost: 0.05 is one in twenty.
void lose(double share);

}  // namespace fieldcast::bench

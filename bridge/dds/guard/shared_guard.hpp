// The guard of one participant, shared by the threads on which its transports receive; and the
// counters of all guards of this process.
#pragma once

#include <mutex>
#include <span>

#include "bridge/dds/guard/datagram_guard.hpp"

namespace fieldcast {

// How many datagrams all guards of this process refused since its start, by cause. Any thread.
[[nodiscard]] RtpsFaultCounts refused_datagrams();

class SharedGuard {
 public:
  explicit SharedGuard(const RtpsLimits& limits) : guard_(limits) {}

  // As DatagramGuard::check(), with the time of the call; `scratch` belongs to the caller's thread.
  // Counts refused datagrams, and logs the first one of a cause, the tenth, the hundredth and so
  // on.
  [[nodiscard]] DatagramGuard::Verdict check(std::span<const std::uint8_t> datagram,
                                             const DatagramGuard::Address& from,
                                             DatagramGuard::Bytes& scratch);

 private:
  std::mutex mutex_;
  DatagramGuard guard_;
};

}  // namespace fieldcast

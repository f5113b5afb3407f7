// Feeds bytes to a receiver at the speed of a line, followed by a long silence.
#pragma once

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim::test {

inline constexpr LineFormat kLine{19200, 8, Parity::kEven, 1};
inline constexpr Instant kBegin{Duration{1'000'000'000}};

// Returns the reaction of the device. REQUIRES: it responds at most once.
inline Reaction listen(Receiver& receiver, ByteView bytes, Instant start = kBegin,
                       bool then_silence = true) {
  Reaction all;
  Instant end = start;
  const auto take = [&](const Reaction& one) {
    if (!one.response.empty()) all.response = one.response;
    all.hang_up = all.hang_up || one.hang_up;
  };
  for (const std::uint8_t byte : bytes) {
    end += kLine.characters(1);
    Reaction one;
    receiver.on_character(byte, end, one);
    take(one);
  }
  if (then_silence && receiver.silence_due() != kNever) {
    Reaction one;
    receiver.on_silence(receiver.silence_due(), one);
    take(one);
  }
  return all;
}

}  // namespace fieldcast::sim::test

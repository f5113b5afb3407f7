// Times of a fenced wire (`fence: listen`). Several bridges may share one line; each derives from
// the configuration how long the sending bridge can be silent.
//
//     last byte ──quiet──┬──hold──┬──hold──┬─slot─┬─slot─ ..
//                        │        claim    listen; rank 0, 1, ..
//                        longest silence of the sending bridge
//
// Pure, any thread.
#pragma once

#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

struct FenceTimes {
  // Pause after which the sending bridge sends a read although none is due.
  Duration hold{};
  // Longest silence of the sending bridge: `hold`, or a timeout and the rest after it.
  Duration quiet{};
  // After a longer silence the bridge has lost the wire and listens before it sends.
  Duration claim{};
  // Another bridge may start. Exceeds `claim` by at least `hold`, the delay of a receiver.
  Duration listen{};
  // Between bridges of different ranks that heard the same silence.
  Duration slot{};
};
[[nodiscard]] FenceTimes fence_times(const BusSpec& bus);

}  // namespace fieldcast

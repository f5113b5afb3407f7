// The times of a fenced wire (`fence: listen`): several bridges may stand at one line, and each
// knows from the configuration for how long the one that sends can be silent.
//
//     last byte ──quiet──┬──hold──┬──hold──┬─slot─┬─slot─ ..
//                        │        claim    listen; rank 0, 1, ..
//                        the longest silence of a bridge that sends
//
// Pure, any thread.
#pragma once

#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

struct FenceTimes {
  // Pause after which the bridge that sends makes itself heard, though nothing is to be read.
  Duration hold{};
  // The longest silence that it makes: `hold`, or a device that does not answer and the rest after
  // it.
  Duration quiet{};
  // After a longer silence it has lost the wire: it listens before it sends.
  Duration claim{};
  // After this silence another one may begin. At least `hold` more than `claim`: so late may a
  // receiver deliver what the other one sent.
  Duration listen{};
  // Between bridges of different ranks that heard the same silence.
  Duration slot{};
};
[[nodiscard]] FenceTimes fence_times(const BusSpec& bus);

}  // namespace fieldcast

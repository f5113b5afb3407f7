// Times of a fenced wire (`fence: listen`). Several bridges may share one line; each derives from
// the configuration how long the sending bridge can be silent.
//
//     last byte ──quiet──┬──hold──┬──hold──┬─slot─┬─slot─ ..
//                        │        claim    listen; rank 0, 1, ..
//                        longest silence of the sending bridge
//
// Pure, any thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"

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

// Describes the fence of a bus in a standby group, for `--check` and the log. Pure, any thread.
struct FenceText {
  std::string text;
  bool missing = false;  // two bridges could send at the same time; the text contains the fix
};
[[nodiscard]] FenceText fence_text(const BusSpec& bus);

// Finds requests of another master in unsolicited bytes. Immutable, any thread.
class RequestFinder {
 public:
  struct Found {
    std::size_t at = 0, size = 0;  // size 0: not found
    bool certain = true;           // false if a device's response can look the same
  };

  explicit RequestFinder(const BusSpec& bus);

  [[nodiscard]] Found find(ByteView bytes) const;
  // A request or a response.
  [[nodiscard]] bool is_frame(ByteView bytes) const;

 private:
  struct Family {
    std::function<SeenRequest(ByteView)> seen;
    std::function<std::vector<FrameField>(ByteView)> explain;
  };
  std::vector<Family> families_;
};

}  // namespace fieldcast

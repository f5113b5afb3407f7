// Decides whether `fieldcast-port --reconnect` connects again after a session has ended, and when.
// Pure; one owner.
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/program/port_client.hpp"

namespace fieldcast::program {

class Reconnection {
 public:
  static constexpr Duration kFirst = std::chrono::seconds{1};
  static constexpr Duration kLongest = std::chrono::seconds{60};
  // After a pairing of this duration the pauses begin with kFirst again.
  static constexpr Duration kProven = std::chrono::seconds{10};

  void paired(Instant now) { paired_at_ = now; }
  // Returns the pause before the next attempt, which doubles up to kLongest. Empty if the end is
  // final: stopped by the user, a refused login, or a peer that is not a bridge.
  [[nodiscard]] std::optional<Duration> ended(const PortEnd& end, Instant now);

 private:
  Instant paired_at_ = kNever;  // kNever: not paired since the last end
  Duration next_ = kFirst;
};

}  // namespace fieldcast::program

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
  // A program that has sent nothing for this time does not need the device now.
  static constexpr Duration kSilent = std::chrono::seconds{10};

  struct Next {
    bool when_program_sends = false;  // otherwise after the pause
    Duration pause{};
    friend bool operator==(const Next&, const Next&) = default;
  };

  void paired(Instant now) { paired_at_ = sent_at_ = now; }
  void program_sent(Instant now) { sent_at_ = now; }
  // Returns when to connect again: after a pause, which doubles up to kLongest, or when the program
  // sends, if the bridge took back a device that was not in use. Empty if the end is final: stopped
  // by the user, a refused login, or a peer that is not a bridge.
  [[nodiscard]] std::optional<Next> ended(const PortEnd& end, Instant now);

 private:
  Instant paired_at_ = kNever;  // kNever: not paired since the last end
  Instant sent_at_ = kNever;    // of the last bytes of the program
  Duration next_ = kFirst;
};

}  // namespace fieldcast::program

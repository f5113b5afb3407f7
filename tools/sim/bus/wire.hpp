// The wire in virtual time: when each character has passed, who received it, and what sending at
// once does to it.
//
// A pseudo-terminal has no baud rate: a request arrives in one piece. Here its characters take
// their time from the moment the first arrives, one after the other; a device's answer is handed
// over as a UART's FIFO would, in pieces, the last exactly when its last stop bit ends. On a
// half-duplex line characters that overlap garble each other. Instants are absolute, so that
// lateness never adds up. Pure: no clock, no I/O.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::sim {

// Who sends: the number of a device on its bus, or one of these.
using Sender = int;
inline constexpr Sender kMaster = -1;
inline constexpr Sender kNobody = -2;  // babble of foreign equipment
inline constexpr Sender kEcho = -3;    // the line giving back what the master sent

struct WireOptions {
  LineFormat line;
  bool paced = true;  // false: characters take no time (plain TCP)
  bool half_duplex = true;
  unsigned fifo = 8;  // characters handed over at a time; 0: the whole answer at its end
  bool echo = false;
  double noise = 0;  // probability that a bit of the line is flipped
  std::uint64_t seed = 1;
};

// Flips bits with a given rate; asks its generator only where the next flipped bit falls.
class BitNoise {
 public:
  BitNoise(double rate, unsigned bits_per_character, std::uint64_t seed);
  [[nodiscard]] std::uint8_t pass(std::uint8_t character);
  [[nodiscard]] std::uint8_t garble(std::uint8_t character);  // at least one bit other

 private:
  void draw();
  double rate_;
  unsigned bits_;
  std::mt19937_64 random_;
  std::uint64_t bits_left_ = 0;  // good bits until the next flipped one
};

// Characters that passed the line, in the order of time.
struct Passed {
  Sender sender = kMaster;
  Bytes characters;
  Instant first_end{};   // end of the first character
  Duration character{};  // from one to the next
};

class Wire {
 public:
  // Characters of the master under way; more are lost and counted.
  static constexpr std::size_t kMaxQueued = 8192;

  explicit Wire(const WireOptions& options);

  // The master's characters arrived at `now`.
  void from_master(ByteView characters, Instant now);
  // Somebody else begins a transmission at `start`.
  void from_device(Sender sender, ByteView characters, Instant start);

  // When advance() has something to do: the end of a piece of the master's, or of the next piece
  // for it. kNever: the line is at rest.
  [[nodiscard]] Instant next_due() const;
  [[nodiscard]] bool at_rest() const { return queued_.empty() && transmissions_.empty(); }
  // The next thing that passed until `now`, or nothing. An answer to it may be added before
  // the next call.
  [[nodiscard]] std::optional<Passed> advance(Instant now);

  // The end of this sender's last transmission that is known; kLongAgo: none under way.
  [[nodiscard]] Instant sends_until(Sender sender) const;
  [[nodiscard]] bool sending(Sender sender, Instant at) const;
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  // The shortest rest seen between the end of any transmission and the master's next character;
  // kNever's distance: none yet.
  [[nodiscard]] std::optional<Duration> shortest_rest() const { return shortest_rest_; }

 private:
  struct Queued {
    std::uint8_t character;
    Instant end, piece_end;  // of itself, and of the piece with which it came
    bool garbled;
  };
  struct Transmission {
    Sender sender;
    Bytes characters;
    std::vector<bool> garbled;
    Instant start;
    std::size_t passed = 0;
  };
  [[nodiscard]] Instant end_of(const Transmission& transmission, std::size_t count) const {
    return transmission.start + Duration{static_cast<std::int64_t>(count) * character_.count()};
  }
  [[nodiscard]] Instant piece_end(const Transmission& transmission) const;
  void collide(Queued& queued, Transmission& transmission);
  void collide(Transmission& a, Transmission& b);
  [[nodiscard]] Passed pass_queued();
  [[nodiscard]] Passed pass_transmission(std::size_t index);

  WireOptions options_;
  Duration character_;
  BitNoise noise_;
  std::deque<Queued> queued_;
  std::vector<Transmission> transmissions_;
  Instant master_free_ = kLongAgo;         // end of the master's last character
  Instant transmission_ended_ = kLongAgo;  // end of the last transmission that passed
  std::uint64_t lost_ = 0, collisions_ = 0;
  std::optional<Duration> shortest_rest_;
};

}  // namespace fieldcast::sim

// Simulates the wire in virtual time: when each character has passed, who received it, and
// collisions.
//
// A pseudo-terminal delivers a request in one piece; here its characters pass one after the other
// from the first arrival. A response is delivered in pieces like those of a UART FIFO, the last one
// exactly at its last stop bit. On a half-duplex line overlapping characters garble each other.
// Instants are absolute, so delays do not add up. Pure: no clock, no I/O.
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

// The index of a device on its bus, or one of these.
using Sender = int;
inline constexpr Sender kMaster = -1;
inline constexpr Sender kNobody = -2;  // babble
inline constexpr Sender kEcho = -3;    // echo of the master's characters by the line

struct WireOptions {
  LineFormat line;
  bool paced = true;  // false: characters need no time (plain TCP)
  bool half_duplex = true;
  unsigned fifo = 8;  // characters of one piece; 0: the whole response
  bool echo = false;
  double noise = 0;  // probability that a bit is flipped
  std::uint64_t seed = 1;
};

// Flips bits at a given rate; draws a random number only for the next flipped bit.
class BitNoise {
 public:
  BitNoise(double rate, unsigned bits_per_character, std::uint64_t seed);
  [[nodiscard]] std::uint8_t pass(std::uint8_t character);
  [[nodiscard]] std::uint8_t garble(std::uint8_t character);  // changes at least one bit

 private:
  void draw();
  double rate_;
  unsigned bits_;
  std::mt19937_64 random_;
  std::uint64_t bits_left_ = 0;  // good bits until the next flipped one
};

struct Passed {
  Sender sender = kMaster;
  Bytes characters;
  Instant first_end{};   // end of the first character
  Duration character{};  // time of one character
};

class Wire {
 public:
  // Limit of queued master characters; further ones are lost and counted.
  static constexpr std::size_t kMaxQueued = 8192;

  explicit Wire(const WireOptions& options);

  void from_master(ByteView characters, Instant now);
  void from_device(Sender sender, ByteView characters, Instant start);

  // Time of the next advance(); kNever: the line is idle.
  [[nodiscard]] Instant next_due() const;
  [[nodiscard]] bool at_rest() const { return queued_.empty() && transmissions_.empty(); }
  // Returns the next passed characters; the caller may add a response before the next call.
  [[nodiscard]] std::optional<Passed> advance(Instant now);

  // End of this sender's last pending transmission; kLongAgo: none.
  [[nodiscard]] Instant sends_until(Sender sender) const;
  [[nodiscard]] bool sending(Sender sender, Instant at) const;
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  // Shortest time from the end of any transmission to the master's next character.
  [[nodiscard]] std::optional<Duration> shortest_rest() const { return shortest_rest_; }

 private:
  struct Queued {
    std::uint8_t character;
    Instant end, piece_end;  // of the character, and of its piece
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
  Instant transmission_ended_ = kLongAgo;  // end of the last complete transmission
  std::uint64_t lost_ = 0, collisions_ = 0;
  std::optional<Duration> shortest_rest_;
};

}  // namespace fieldcast::sim

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
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "tools/sim/device/device.hpp"

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

  // `response_baud`: the rate at which the master then receives, if known; 0: that of the line.
  // Characters of another rate are garbled.
  void from_master(ByteView characters, Instant now,
                   std::optional<std::uint32_t> response_baud = {});
  void from_device(Sender sender, ByteView characters, Instant start, std::uint32_t baud = 0);

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
    std::uint32_t baud = 0;  // 0: that of the line
    std::size_t passed = 0;
  };
  [[nodiscard]] Duration character_of(const Transmission& transmission) const {
    return transmission.baud == 0 ? character_
                                  : character_ * options_.line.baud / transmission.baud;
  }
  [[nodiscard]] Instant end_of(const Transmission& transmission, std::size_t count) const {
    return transmission.start + static_cast<std::int64_t>(count) * character_of(transmission);
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
  std::optional<std::uint32_t> response_baud_;  // see from_master()
  Instant master_free_ = kLongAgo;              // end of the master's last character
  Instant transmission_ended_ = kLongAgo;       // end of the last complete transmission
  std::uint64_t lost_ = 0, collisions_ = 0;
  std::optional<Duration> shortest_rest_;
};

inline constexpr Duration kForever = Duration::max();
struct Window {
  Duration from{}, to = kForever;
  [[nodiscard]] bool holds(Duration since_start) const {
    return since_start >= from && since_start < to;
  }
};

// From the last character of the request to the first of the response.
struct ResponseDelay {
  Duration base = std::chrono::milliseconds{2};
  Duration spread{};  // random addition up to this, uniform
  double spike_probability = 0;
  Duration spike{};  // occasional addition
};

struct DeviceFaults {
  ResponseDelay delay;
  double loss = 0;              // probability that the response is not sent
  double late_probability = 0;  // probability that the response is sent after the time `late`
  Duration late{};
  bool queues = false;          // accepts further requests while it is busy and responds in order
  double doubled = 0;           // probability that the response is sent twice
  Duration doubled_after{};     // time between the two responses
  Duration deaf{};              // ignores the line for this time after each response
  double garble = 0;            // probability of wrong characters
  double truncate = 0;          // probability of a truncated response
  double stray = 0;             // probability of stray characters before the response
  std::vector<Window> silence;  // the device neither receives nor sends
  std::vector<RefusedRange> refused;
  bool only_configured = false;
  std::optional<unsigned> form;  // of its responses, if it has several; empty: they change
};

struct BusFaults {
  double noise = 0;  // probability that a bit on the line is flipped
  bool echo = false;
  double babble = 0;           // bursts of random characters a second
  unsigned babble_length = 8;  // characters of the longest burst
  // exchanges a second of a second master
  double foreign = 0;
  std::vector<Window> unplugged;  // the port is missing
  unsigned fifo = 8;
  std::map<std::string, DeviceFaults> devices;  // by name; other devices have no faults
};

struct Faults {
  std::map<std::string, BusFaults> buses;  // by name; other buses have no faults
};

struct FaultyResponse {
  Bytes characters;  // empty: lost
  Duration delay{};
  bool doubled = false;
};

// Random faults of one device. The same seed and the same requests give the same faults.
class FaultDice {
 public:
  FaultDice(const DeviceFaults& faults, std::uint64_t seed) : faults_(faults), random_(seed) {}
  [[nodiscard]] FaultyResponse roll(Bytes response);
  [[nodiscard]] bool dead(Duration since_start) const;
  [[nodiscard]] const DeviceFaults& faults() const { return faults_; }
  [[nodiscard]] std::uint64_t late() const { return late_; }        // late responses so far
  [[nodiscard]] std::uint64_t doubled() const { return doubled_; }  // doubled responses so far

 private:
  [[nodiscard]] bool happens(double probability);
  DeviceFaults faults_;
  std::mt19937_64 random_;
  std::uint64_t late_ = 0, doubled_ = 0;
};

}  // namespace fieldcast::sim

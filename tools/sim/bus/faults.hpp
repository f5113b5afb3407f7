// What goes wrong in the plant: plain values, read from the faults file (fault_file.hpp) or made by
// a test; and their effect on one answer.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

// Since the plant's start; `to` is kForever where nothing ends it.
inline constexpr Duration kForever = Duration::max();
struct Window {
  Duration from{}, to = kForever;
  [[nodiscard]] bool holds(Duration since_start) const {
    return since_start >= from && since_start < to;
  }
};

// From the last character of the request to the first of the answer.
struct AnswerDelay {
  Duration base = std::chrono::milliseconds{2};
  Duration spread{};  // up to this much more, evenly distributed
  double spike_probability = 0;
  Duration spike{};  // this much more, now and then
};

struct DeviceFaults {
  AnswerDelay delay;
  double loss = 0;              // the answer never leaves
  double late_probability = 0;  // the answer leaves much later
  Duration late{};
  bool queues = false;       // while it thinks, it takes further requests and answers them in order
  double doubled = 0;        // the answer comes twice
  Duration doubled_after{};  // the time between the two answers
  Duration deaf{};           // after each of its answers
  double garble = 0;         // some characters of the answer are other ones
  double truncate = 0;       // the answer ends early
  double stray = 0;          // stray characters precede the answer
  std::vector<Window> silence;  // the device is dead: it neither receives nor answers
  std::vector<RefusedRange> refused;
  bool only_configured = false;
};

struct BusFaults {
  double noise = 0;  // probability that a bit on the line is flipped
  bool echo = false;
  double babble = 0;           // bursts a second of foreign characters
  unsigned babble_length = 8;  // characters of the longest burst
  double foreign = 0;  // conversations a second of another master with a unit that is not ours
  std::vector<Window> unplugged;  // the port vanishes and comes back
  unsigned fifo = 8;
  std::map<std::string, DeviceFaults> devices;  // by name; others have none
};

struct Faults {
  std::map<std::string, BusFaults> buses;  // by name; others have none
};

// An answer as it really goes out.
struct FaultyAnswer {
  Bytes characters;  // empty: lost
  Duration delay{};
  bool doubled = false;
};

// The random faults of one device: the same seed and the same requests give the same faults.
class FaultDice {
 public:
  FaultDice(const DeviceFaults& faults, std::uint64_t seed) : faults_(faults), random_(seed) {}
  [[nodiscard]] FaultyAnswer roll(Bytes answer);
  [[nodiscard]] bool dead(Duration since_start) const;
  [[nodiscard]] const DeviceFaults& faults() const { return faults_; }
  [[nodiscard]] std::uint64_t late() const { return late_; }        // answers so far
  [[nodiscard]] std::uint64_t doubled() const { return doubled_; }  // of them

 private:
  [[nodiscard]] bool happens(double probability);
  DeviceFaults faults_;
  std::mt19937_64 random_;
  std::uint64_t late_ = 0, doubled_ = 0;
};

}  // namespace fieldcast::sim

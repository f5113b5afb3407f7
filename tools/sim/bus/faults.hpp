// Simulated faults, set by the faults file (fault_file.hpp) or a test. Plain values.
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

// Time since the start of the plant.
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
  [[nodiscard]] FaultyResponse roll(Bytes answer);
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

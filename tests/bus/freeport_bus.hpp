// Simulates S7 freeport stations on one noisy line, polled by the whole bus engine in virtual time,
// and counts the wrong values that are published.
//
// The line is 9600 baud, 8N1, with stations 1..n. The four bytes of a station are random and change
// with each response, so every value of another time or station is recognised as wrong. Each
// direction has its own UART (tests/support/noisy_uart.hpp). The stations do not use the core's
// codec.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <random>

#include "core/bus/bus_engine.hpp"
#include "tests/support/noisy_uart.hpp"

namespace fieldcast::test {

class FreeportStations {
 public:
  FreeportStations(unsigned count, std::uint64_t seed);
  // Returns what the stations send after they received `received`: a response, a refusal, or empty.
  [[nodiscard]] Bytes answer(ByteView received);
  // Returns the value of the station's last response.
  [[nodiscard]] std::uint32_t window(unsigned station) const { return windows_.at(station); }

 private:
  std::map<unsigned, std::uint32_t> windows_;
  std::mt19937_64 random_;
};

class FreeportBus {
 public:
  struct Counts {
    std::uint64_t exchanges = 0;
    std::uint64_t right = 0, wrong = 0;  // good samples, by correctness of the value
    std::uint64_t bad = 0;
  };

  FreeportBus(unsigned stations, double bit_error_rate, std::uint64_t seed, Duration response_time);
  void run(std::uint64_t exchanges);

  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] Duration elapsed() const { return now_ - Instant{}; }
  [[nodiscard]] CauseCounters causes() { return engine_.bus_report(now_).causes; }
  [[nodiscard]] std::uint64_t flipped() const {
    return to_stations_.flipped() + to_master_.flipped();
  }

 private:
  void feed(const BusEvent& event);
  void act(const Send& send);
  void publish(const Sample& sample);

  BusEngine engine_;
  FreeportStations stations_;
  NoisyUart to_stations_, to_master_;
  const Duration response_time_;
  Instant now_{}, timer_ = kNever, arrives_ = kNever;
  Bytes arriving_;
  Actions actions_;
  Counts counts_;
};

}  // namespace fieldcast::test

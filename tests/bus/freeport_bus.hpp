// S7 freeport stations on a noisy line, polled by the complete bus engine in virtual time: measures
// how often a wrong value is published.
//
// 9600 baud, 8N1, stations 1..n. The four bytes of a station are random and new in each response,
// so that every value of another time or station is recognized as wrong. Each direction passes its
// own UART (tests/support/noisy_uart.hpp). The stations are written from the rules of the protocol,
// independently of the core's codec.
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
  // Returns the bytes on the line after the stations received a request: a response, a refusal, or
  // empty.
  [[nodiscard]] Bytes answer(ByteView received);
  // The value of the last response.
  [[nodiscard]] std::uint32_t window(unsigned station) const { return windows_.at(station); }

 private:
  std::map<unsigned, std::uint32_t> windows_;
  std::mt19937_64 random_;
};

class FreeportBus {
 public:
  struct Counts {
    std::uint64_t exchanges = 0;         // requests sent
    std::uint64_t right = 0, wrong = 0;  // samples of good quality, by their value
    std::uint64_t bad = 0;               // samples of bad quality
  };

  FreeportBus(unsigned stations, double bit_error_rate, std::uint64_t seed, Duration answer_time);
  void run(std::uint64_t exchanges);

  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] Duration elapsed() const { return now_ - Instant{}; }
  // Causes of failed exchanges.
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
  const Duration answer_time_;
  Instant now_{}, timer_ = kNever, arrives_ = kNever;
  Bytes arriving_;
  Actions actions_;
  Counts counts_;
};

}  // namespace fieldcast::test

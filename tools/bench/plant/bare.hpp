// A bare Fast DDS writer and reader with the same data as a bridge and its stations, as a
// reference. Uses the library's QoS except for reliability and limits, and UDP over the loopback.
// write() has one caller; the reader's handler runs on a DDS thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "tools/bench/plant/plant.hpp"

namespace fieldcast::bench {

enum class BareData : std::uint8_t {
  kBlocks,   // unkeyed messages with the bytes of fieldcast/SampleBlock
  kSamples,  // keyed, with the bytes of fieldcast/Sample
};

class BareWriter {
 public:
  // Throws std::runtime_error.
  BareWriter(unsigned domain, BareData data, std::size_t channels);
  ~BareWriter();
  BareWriter(const BareWriter&) = delete;
  BareWriter& operator=(const BareWriter&) = delete;

  // Writes the next `rows` channels; each sample has `number` and the start time of the call.
  void write(std::size_t rows, std::uint64_t number);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

class BareReader {
 public:
  struct Row {
    std::uint64_t number;
    std::chrono::steady_clock::time_point written;
  };
  // Throws std::runtime_error.
  BareReader(unsigned domain, BareData data, std::function<void(const Row&)> on_row);
  ~BareReader();
  BareReader(const BareReader&) = delete;
  BareReader& operator=(const BareReader&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct BareLoad {
  std::size_t channels = 0;
  std::size_t rows = 0;  // of a block
  double blocks_a_second = 0;
};

class BarePair {
 public:
  BarePair(const ScratchFolder& folder, unsigned domain, BareData data, const BareLoad& load);

  struct Spent {
    std::uint64_t written = 0, received = 0;  // samples
    double writer = 0, reader = 0;            // processor seconds
  };
  [[nodiscard]] Spent spent() const;

 private:
  std::string reader_log_, writer_log_;
  Process reader_, writer_;
};

}  // namespace fieldcast::bench

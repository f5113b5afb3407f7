// A bare Fast DDS writer and reader with the same data as a bridge and its stations, as a
// reference. Uses the library's QoS except for reliability and limits, and UDP over the loopback.
// write() has one caller; the reader's handler runs on a DDS thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

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

}  // namespace fieldcast::bench

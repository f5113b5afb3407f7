// Measures a bare Fast DDS writer and reader (bare.hpp), each in its own process. Main thread.
#pragma once

#include <cstdint>
#include <string>

#include "tools/bench/plant/bare.hpp"
#include "tools/bench/plant/process.hpp"

namespace fieldcast::bench {

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

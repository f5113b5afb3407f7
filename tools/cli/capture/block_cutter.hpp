// Splits a pcapng stream into whole blocks. Pure; buffers an incomplete block.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::cli {

class BlockCutter {
 public:
  struct Block {
    std::uint32_t type = 0;
    Bytes bytes;
  };
  // Adds bytes and returns the complete blocks.
  [[nodiscard]] std::vector<Block> take(ByteView bytes);
  [[nodiscard]] bool broken() const { return broken_; }  // the stream is not pcapng

 private:
  Bytes waiting_;
  bool broken_ = false;
};

}  // namespace fieldcast::cli

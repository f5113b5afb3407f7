// Cuts a stream of pcapng into whole blocks. Pure; owns what came of the next block.
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
  // The whole blocks that are there now; the rest waits.
  [[nodiscard]] std::vector<Block> take(ByteView bytes);
  [[nodiscard]] bool broken() const { return broken_; }  // that is no pcapng

 private:
  Bytes waiting_;
  bool broken_ = false;
};

}  // namespace fieldcast::cli

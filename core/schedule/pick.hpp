// One read as the scheduler chose it: points of one cluster, and the request that brings them.
// Owned by the scheduler and used again for every choice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct Pick {
  std::vector<std::uint32_t>
      members;  // places within the cluster, rising: all that the ranges bring, ready or not
  Request request = ReadRequest{};
  std::int64_t cost = 0;  // of the wire

  [[nodiscard]] std::vector<Range>& ranges() { return std::get<ReadRequest>(request).ranges; }
  [[nodiscard]] const std::vector<Range>& ranges() const {
    return std::get<ReadRequest>(request).ranges;
  }
};

}  // namespace fieldcast

// One read as it was selected: points of one group, and the request that brings them. Its vectors
// are used again for every selection.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct Selection {
  // Indexes within the group, rising: all points that the ranges bring, ready or not.
  std::vector<std::uint32_t> members;
  Request request = ReadRequest{};
  Duration cost{};  // of the wire

  [[nodiscard]] std::vector<Range>& ranges() { return std::get<ReadRequest>(request).ranges; }
  [[nodiscard]] const std::vector<Range>& ranges() const {
    return std::get<ReadRequest>(request).ranges;
  }
};

}  // namespace fieldcast

// One selected read. Reused for every selection.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct Selection {
  // Ascending indexes within the group: all covered points, ready or not.
  std::vector<std::uint32_t> members;
  Request request = ReadRequest{};
  Duration cost{};  // wire time

  [[nodiscard]] std::vector<Range>& ranges() { return std::get<ReadRequest>(request).ranges; }
  [[nodiscard]] const std::vector<Range>& ranges() const {
    return std::get<ReadRequest>(request).ranges;
  }
};

}  // namespace fieldcast

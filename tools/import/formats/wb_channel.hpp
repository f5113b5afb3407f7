// Converts an entry of wb-mqtt-serial `channels` to a point. Pure.
#pragma once

#include "tools/import/points/model.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {

struct WbBase {
  std::uint32_t shift = 0;   // registers
  std::uint32_t stride = 0;  // multiplied by the registers of each value
};

// `point` has its name and origin. Returns the reason if it cannot be imported.
[[nodiscard]] MayFail read_wb_channel(const Node& channel, const WbBase& base, Point& point);

}  // namespace fieldcast::importing

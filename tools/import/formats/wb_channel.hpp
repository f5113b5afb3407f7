// One channel of wb-mqtt-serial: an entry of `channels` as a point. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/model.hpp"
#include "tools/import/tree.hpp"

namespace fieldcast::importing {

// Where the addresses of a part of a device begin.
struct WbBase {
  std::uint32_t shift = 0;   // registers
  std::uint32_t stride = 0;  // times the registers of each value
};

// Fills a point whose name and origin are set. The fault: why it cannot be moved.
[[nodiscard]] std::optional<std::string> read_wb_channel(const Node& channel, const WbBase& base,
                                                         Point& point);

}  // namespace fieldcast::importing

// Writes a channel in YAML or as a row of a list. Keys common to all channels are written at the
// device. Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

struct SharedKeys {
  std::optional<Duration> refresh;
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
};

// "uint16", "string(20)".
[[nodiscard]] std::string type_text(const Point& point);

// REQUIRES: the device has points.
[[nodiscard]] SharedKeys shared_keys(const Device& device);

// "{ name: power, at: "holding:10", type: float32 }"
[[nodiscard]] std::string yaml_channel(const Point& point, const SharedKeys& shared);

[[nodiscard]] std::vector<std::string> csv_columns(const Device& device, const SharedKeys& shared);
[[nodiscard]] std::string csv_row(const Point& point, const SharedKeys& shared,
                                  const std::vector<std::string>& columns);

}  // namespace fieldcast::importing

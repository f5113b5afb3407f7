// Converts a Neuron tag to a point. Pure.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

struct NeuronTag {
  std::string name, address, type, attribute, description;
  std::optional<double> decimal, bias, interval_ms;
};

// Settings of the node; 1 is the default.
struct NeuronOrders {
  unsigned of_32 = 1, of_64 = 1;
  std::uint32_t base = 1;  // first address
};

struct ReadTag {
  std::uint16_t slave = 0;
  Point point;
};
// The error is the reason for a refusal.
[[nodiscard]] tl::expected<ReadTag, std::string> read_neuron_tag(const NeuronTag& tag,
                                                                 const NeuronOrders& orders);

}  // namespace fieldcast::importing

// The calculated channels of one bus: keeps the last state of each input, and evaluates the
// channels whose inputs have changed. Owned by the bus engine, on the bus's thread.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/calculate/evaluation.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

// The inputs of a bus that belong to other buses, without duplicates.
[[nodiscard]] std::vector<ChannelPath> foreign_inputs(const BusSpec& bus);

class Calculator {
 public:
  // REQUIRES: the loader made the bus, so no channel is calculated from itself.
  explicit Calculator(const BusSpec& bus);

  [[nodiscard]] bool empty() const { return entries_.empty(); }

  // New samples of this bus, or of inputs on other buses.
  void take(std::span<const Sample> samples);
  void take(std::span<const InputSample> samples);

  // Calls `publish` for each channel with a new input since the last call. A channel follows the
  // calculated channels that are its inputs.
  using Publish = std::function<void(ChannelIndex, const Calculated&)>;
  void update(const Publish& publish);

 private:
  struct Entry {
    ChannelIndex channel = 0;
    ValueType type = ValueType::kFloat64;
    Formula formula;
    std::vector<InputState> inputs;
    bool changed = false;
  };
  struct Use {
    std::size_t entry = 0, argument = 0;
  };
  using Uses = std::vector<Use>;
  void take(const Uses& uses, const InputState& state);

  std::vector<Entry> entries_;  // each behind its inputs
  std::vector<Uses> uses_;      // by channel of this bus
  std::vector<Uses> foreign_;   // by foreign input
};

}  // namespace fieldcast

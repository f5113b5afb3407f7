// Computes the share of the wire of one group by simulating its reads. Holds scratch memory.
#pragma once

#include <span>
#include <vector>

#include "core/plan/wire_model.hpp"

namespace fieldcast {

class GroupLoad {
 public:
  explicit GroupLoad(const WireModel& wire)
      : wire_(wire), selector_(wire.rules.shape, wire.weights) {}

  struct Terms {
    Duration period{};       // present period of the group; zero if none
    Duration fastest{1};     // smallest allowed gap of the bus
    double margin = 0;       // of the bus
    bool stretched = false;  // uses stretched refreshes instead of requested ones
  };
  // As if the group were alone on the wire. `points`: those of the group.
  [[nodiscard]] double of(const Group& group, std::span<const PlannedPoint> points,
                          const Terms& terms);

 private:
  void imagine(std::span<const PlannedPoint> points, bool stretched);
  [[nodiscard]] std::uint32_t most_urgent() const;

  const WireModel& wire_;
  ReadSelector selector_;
  std::vector<PointState> imagined_;
};

}  // namespace fieldcast

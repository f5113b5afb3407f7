// One selected read. Reused for every selection.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/layout.hpp"
#include "core/plan/shape/block_shape.hpp"
#include "core/plan/shape/point_state.hpp"
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

// Selects the points of a group that are read together with a list of ranges: the most urgent
// point, those that would need a request before the group's next one, and, with spare wire time,
// those better read now than later. Limits of request and response matter, distance does not.
class ListShaper {
 public:
  // `points`: one group, ordered by area and address. Respects cuts; skips bad points.
  void cyclic(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
              Instant now, const Allowance& allowance, const CyclicWeights& weights,
              Selection& out);
  void whole(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
             Instant now, Selection& out);

 private:
  struct Candidate {
    Instant due;
    std::uint32_t index;  // within the group
  };
  // Starts a selection with the urgent point, limited by cuts.
  void confine(std::span<const PointState> points, std::uint32_t urgent, Instant now);
  // Adds the most urgent points first, within the limits of the request and `budget`.
  void take(std::span<const PointState> points, const ListCost& cost, Duration budget,
            Selection& out);
  bool build(std::span<const PointState> points, const ListCost& cost, Duration budget,
             Selection& out);
  void cover(std::span<const PointState> points, Selection& out) const;

  Slice reach_{};
  std::vector<Candidate> candidates_;
  std::vector<std::uint8_t> taken_;  // by index within the group
  Selection attempt_;
};

// Selects the points of a group's next read and builds its request. Holds scratch memory.
enum class ShapeRule : std::uint8_t {
  kCyclic,  // those due before the group is read again; lists of ranges if possible
  kNear,    // those that have used half of their allowed gap
  kWhole,   // the whole group
  kSingle,  // none
};

class ReadSelector {
 public:
  explicit ReadSelector(ShapeRule rule, const CyclicWeights& weights = {})
      : rule_(rule), weights_(weights) {}

  // `points`: those of `group`; `urgent`: index within it. The result is valid until the next call.
  const Selection& select(const Layout& layout, const Group& group,
                          std::span<const PointState> points, std::uint32_t urgent, Instant now,
                          const Allowance& allowance);
  [[nodiscard]] Duration cost_of(const Layout& layout, const Group& group,
                                 std::span<const PointState> points, std::uint32_t urgent,
                                 Instant now, const Allowance& allowance);

 private:
  [[nodiscard]] Slice slice_of(const ReadCost& cost, std::span<const PointState> points,
                               std::uint32_t urgent, Instant now, const Allowance& allowance) const;

  ShapeRule rule_;
  CyclicWeights weights_;
  ListShaper lists_;
  Selection selection_;
};

}  // namespace fieldcast

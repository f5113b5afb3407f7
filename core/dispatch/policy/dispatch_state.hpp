// A priority queue of small integers by time, whose entries can be moved and removed. Logarithmic;
// does not allocate after construction.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/dispatch/policy/decision.hpp"
#include "core/plan/layout/time_math.hpp"
#include "core/plan/read_plan.hpp"
#include "core/plan/refresh.hpp"
#include "core/plan/wire_model.hpp"

namespace fieldcast {

class DueQueue {
 public:
  explicit DueQueue(std::size_t size) : node_of_(size, kOut), key_(size) { heap_.reserve(size); }

  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }
  [[nodiscard]] std::uint32_t top() const { return heap_.front(); }
  [[nodiscard]] Instant top_key() const { return key_[heap_.front()]; }
  [[nodiscard]] bool holds(std::uint32_t id) const { return node_of_[id] != kOut; }
  // For partial walks: the children of node i are 2i+1 and 2i+2.
  [[nodiscard]] std::uint32_t at(std::size_t node) const { return heap_[node]; }
  [[nodiscard]] Instant key(std::uint32_t id) const { return key_[id]; }

  void put(std::uint32_t id, Instant key) {
    key_[id] = key;
    if (node_of_[id] == kOut) {
      node_of_[id] = static_cast<std::uint32_t>(heap_.size());
      heap_.push_back(id);
    }
    down(up(node_of_[id]));
  }

  void remove(std::uint32_t id) {
    const std::uint32_t node = node_of_[id];
    if (node == kOut) return;
    const std::uint32_t last = heap_.back();
    heap_.pop_back();
    node_of_[id] = kOut;
    if (last == id) return;
    heap_[node] = last;
    node_of_[last] = node;
    down(up(node));
  }

 private:
  static constexpr std::uint32_t kOut = ~0u;

  void swap_nodes(std::uint32_t a, std::uint32_t b) {
    std::swap(heap_[a], heap_[b]);
    node_of_[heap_[a]] = a;
    node_of_[heap_[b]] = b;
  }
  std::uint32_t up(std::uint32_t node) {
    while (node > 0 && key_[heap_[node]] < key_[heap_[(node - 1) / 2]]) {
      swap_nodes(node, (node - 1) / 2);
      node = (node - 1) / 2;
    }
    return node;
  }
  void down(std::uint32_t node) {
    for (;;) {
      std::uint32_t least = node;
      for (std::uint32_t child = 2 * node + 1; child <= 2 * node + 2 && child < heap_.size();
           ++child) {
        if (key_[heap_[child]] < key_[heap_[least]]) least = child;
      }
      if (least == node) return;
      swap_nodes(node, least);
      node = least;
    }
  }

  std::vector<std::uint32_t> heap_;     // ids
  std::vector<std::uint32_t> node_of_;  // by id
  std::vector<Instant> key_;            // by id
};

// How much earlier than planned the reads of a device end: a read planned for the nominal rate of a
// faster converter or pseudo-terminal would end too early and be repeated. Plain value.
class LinePace {
 public:
  // `took`, `planned`: time until the end of the response.
  void read(Duration took, Duration planned) {
    if (planned <= Duration::zero()) return;
    const double share = ns(took) / ns(planned);
    slowest_ = std::max(slowest_, std::min(share, 1.0));
    if (++reads_ < kWindow) return;
    before_ = slowest_;
    slowest_ = 0;
    reads_ = 0;
  }
  // At most 1: the slowest of the last reads. Ignores small differences.
  [[nodiscard]] double share() const {
    const double share = std::max(before_, slowest_);
    return share < kNotable ? share : 1.0;
  }
  [[nodiscard]] Duration of(Duration planned) const {
    const double paced = share();
    return paced < 1 ? part_of(paced, planned) : planned;
  }

 private:
  static constexpr int kWindow = 16;
  static constexpr double kNotable = 0.9;
  double before_ = 1, slowest_ = 0;
  int reads_ = 0;
};

// State of dispatching between two reads: every point and group, and the queues of groups. The plan
// in force is passed to each call. Copyable for rehearsals. Owned by the plan runner, on the thread
// of its bus. A group with points to read is in `held` until its read may begin, then in `due`. It
// may also be in `spare`, if it can use spare wire time, and in `asleep`, if some of its points are
// paused.
struct GroupState {
  std::uint32_t urgent = 0;        // index within the group of the point that is due first
  std::uint32_t spare_urgent = 0;  // the first due of the points for spare wire time
  Instant due = kNever;            // its next read
  Duration cost{};                 // wire time of that read
  Cycle cycle;                     // of its reads
};

struct GroupQueues {
  explicit GroupQueues(std::size_t groups)
      : due(groups), held(groups), spare(groups), asleep(groups) {}
  void take_out(GroupIndex group);

  DueQueue due;     // by due time
  DueQueue held;    // by earliest start
  DueQueue spare;   // by due time of its first point for spare time
  DueQueue asleep;  // by wake-up time of its first point
};

struct DispatchState {
  DispatchState(WireModel model, std::span<const PlannedPoint> planned, const ReadPlan& plan);

  [[nodiscard]] std::span<PointState> points_of(const ReadPlan& plan, GroupIndex group);
  // `from`: points of the group, real or simulated.
  const Selection& select(const ReadPlan& plan, GroupIndex group, std::span<const PointState> from,
                          std::uint32_t urgent, Instant now, Duration budget);
  [[nodiscard]] Block make_block(const ReadPlan& plan, GroupIndex group, std::uint32_t urgent,
                                 Instant now, Duration budget);
  // Needs at most `free`; empty if there is none.
  [[nodiscard]] std::optional<Block> spare_read(const ReadPlan& plan, Instant now, Duration free);
  [[nodiscard]] Instant next_wake() const;
  // The last planned acquisition of a point up to `until`. REQUIRES: the point has a period.
  [[nodiscard]] Instant last_instant(const ReadPlan& plan, OrderIndex point, Instant until) const;
  // Updates `asleep` and `spare`. Returns the due time of the group's next read; kNever if none.
  [[nodiscard]] Instant find_urgent(const ReadPlan& plan, GroupIndex group, Instant now);

  // Computes the wire time at the pace of the device.
  void set_next_read(const ReadPlan& plan, GroupIndex group, Instant due, Instant now);

  WireModel wire;
  Instant table_began{};
  std::vector<PointState> points;        // by OrderIndex
  std::vector<GroupState> groups;        // as in the plan
  std::vector<LinePace> paces;           // by device
  std::vector<Instant> suspended_until;  // by device
  DueQueue suspended;                    // devices, by end of their pause
  GroupQueues queues;
  ReadSelector selector;
};

}  // namespace fieldcast

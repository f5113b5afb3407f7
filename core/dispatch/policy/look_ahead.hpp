// Simulates all reads as late as possible, to find how long the wire may rest without a timetable.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/dispatch/policy/dispatch_state.hpp"

namespace fieldcast {

class LookAhead {
 public:
  // Part of the fastest allowed gap by which a rest ends early.
  static constexpr double kReserve = 0.25;

  // Sets the group's next read, due at `due`, and puts it into the queue `due`.
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex group, Instant due,
               Instant now);
  // Negative if a read is late. REQUIRES: the queue `due` is not empty.
  [[nodiscard]] Duration rest(const ReadPlan& plan, const DispatchState& state, Instant now);

  // Every read is due an allowed gap after the last one.
  static void renew(PointState& point, Instant acquired) {
    point.due = point.deadline = later(acquired, point.allowed_gap);
  }

 private:
  static constexpr std::size_t kReads = 6;
  struct Coming {
    Instant due = kNever;
    Duration cost{};
    // An earlier read contains its most urgent point: both become due earlier by the same time.
    bool again = false;
  };
  struct Ahead {  // kept small, as heaps of it determine the time of a decision
    Instant due;
    GroupIndex group;
    std::uint32_t node : 28;  // in the queue; kNoNode: a repetition
    std::uint32_t step : 4;   // index in the group's next reads
  };
  static constexpr std::uint32_t kNoNode = (1u << 28) - 1;

  void push(const Ahead& ahead);
  [[nodiscard]] Ahead pop();

  std::vector<std::array<Coming, kReads>> coming_;  // by group
  std::vector<Ahead> heap_;                         // scratch of rest()
  std::vector<PointState> imagined_;                // scratch of enqueue()
};

}  // namespace fieldcast

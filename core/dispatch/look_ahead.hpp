// How long the wire may rest when there is no timetable: the next reads of all groups, imagined as
// late as possible, one after the other. Owned by the dispatchers that have no timetable.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/dispatch/dispatch_state.hpp"

namespace fieldcast {

class LookAhead {
 public:
  // A rest ends before it must, by this part of the fastest allowed gap.
  static constexpr double kReserve = 0.25;

  // Reads the group in imagination, each time at the last moment. Sets its next read, which is due
  // at `due`, and puts it into the queue `due`.
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex group, Instant due,
               Instant now);
  // How long the wire may rest before something must begin; negative: something is late.
  // REQUIRES: the queue `due` is not empty.
  [[nodiscard]] Duration rest(const ReadPlan& plan, const DispatchState& state, Instant now);

  // Every read is due an allowed gap after the last one.
  static void renew(PointState& point, Instant acquired) {
    point.due = point.deadline = later(acquired, point.allowed_gap);
  }

 private:
  static constexpr std::size_t kReads = 6;
  // One of the next reads of a group, if each is made as late as possible.
  struct Coming {
    Instant due = kNever;
    Duration cost{};
    // Its most urgent point is read by one of the reads before it. When that read is made sooner,
    // this one is due sooner by as much.
    bool again = false;
  };
  struct Ahead {  // small: heaps of it are what a decision costs
    Instant due;
    GroupIndex group;
    std::uint32_t node : 28;  // in the queue; kNoNode: a repetition
    std::uint32_t step : 4;   // in the group's next reads
  };
  static constexpr std::uint32_t kNoNode = (1u << 28) - 1;

  void push(const Ahead& ahead);
  [[nodiscard]] Ahead pop();

  std::vector<std::array<Coming, kReads>> coming_;  // by group
  std::vector<Ahead> heap_;                         // scratch of rest()
  std::vector<PointState> imagined_;                // scratch of enqueue()
};

}  // namespace fieldcast

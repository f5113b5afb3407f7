// What a bus will do before it does it: the scheduler itself, run in virtual time over an ideal
// wire. It begins as the bus engine does, with an assumed answer time, learns the true one from the
// answers, and changes its plan as that does.
//
// Deterministic, no clock; a few hundred milliseconds of work at most. For `fieldcast plan`, and
// for the check of a configuration.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/dispatch/scheduler.hpp"
#include "core/schedule/remedies.hpp"

namespace fieldcast {

struct PredictionOptions {
  // Virtual time; 0: three times the longest refresh, at least 60 s and at most an hour.
  Duration horizon{};
  std::uint64_t max_reads = 100'000;  // the run ends here at the latest
  bool remedies = true;               // when infeasible, look for what would work
  Planner planner = Planner::kCyclic;
  // What the scheduler takes for the answer time of every device before it has learned that of the
  // input; nothing: it knows it.
  std::optional<Duration> assumed;
};

// What one point will get.
struct PointForecast {
  Duration refresh{};    // as asked for
  Duration worst_gap{};  // between two samples; the whole run if it was read less than twice
  std::uint64_t reads = 0;
  std::uint64_t missed = 0;  // gaps longer than the refresh
};

// One block as it will be seen on the wire. The reads of one group vary; each of its shapes is a
// block of its own.
struct BlockForecast {
  DeviceIndex device = 0;
  std::vector<Range> ranges;
  std::size_t points = 0;
  Duration cost{};  // of the wire
  double per_second = 0;
};

struct Prediction {
  bool feasible = false;  // nothing is read later than its refresh allows, now or in a longer run
  // Not feasible, though this run missed nothing: with refreshes 5 % shorter it would have.
  bool narrow = false;
  // Share of the wire that the refreshes asked for need; above 1: how many wires.
  double planned_load = 0;
  double load = 0;     // share of the wire that the run used
  double stretch = 1;  // factor on all refreshes by which overload is met
  Duration horizon{};  // virtual time that was run
  std::uint64_t reads = 0, missed = 0;
  std::vector<PointForecast> points;  // in the order of the input
  std::vector<BlockForecast> blocks;  // by device and address; at most 1 000, the most frequent
  ReadPlan plan;                      // in force at the end of the run
  Remedies remedies;                  // empty when feasible
};

[[nodiscard]] Prediction predict(const ScheduleInput& input, const PredictionOptions& options = {});

}  // namespace fieldcast

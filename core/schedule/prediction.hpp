// Predicts the behaviour of a bus, for `fieldcast plan` and the check of a configuration: runs its
// scheduler in virtual time over an ideal wire. It starts with an assumed response time and learns
// the true one, as the bus engine does. Deterministic; lasts at most a few hundred milliseconds.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/dispatch/scheduler.hpp"
#include "core/schedule/overload.hpp"

namespace fieldcast {

struct PredictionOptions {
  // Virtual time; 0: three times the longest refresh, at least 60 s and at most an hour.
  Duration horizon{};
  std::uint64_t max_reads = 100'000;  // limit of the run
  bool remedies = true;               // if infeasible, search for remedies
  // Searches for rounds of equal length, as the engine does. Remedies are tried without.
  bool search = true;
  Planner planner = Planner::kCyclic;
  // Initial response time of every device in the scheduler; empty: that of the input.
  std::optional<Duration> assumed;
};

struct PointForecast {
  Duration refresh{};    // as requested
  Duration worst_gap{};  // between two samples; the whole run if it was read less than twice
  std::uint64_t reads = 0;
  std::uint64_t missed = 0;  // gaps longer than the refresh
};

// The reads of a group vary; each shape is a separate block.
struct BlockForecast {
  DeviceIndex device = 0;
  std::vector<Range> ranges;
  std::size_t points = 0;
  Duration cost{};  // wire time
  double per_second = 0;
};

struct Prediction {
  bool feasible = false;  // no read is later than its refresh allows, now or in a longer run
  // The run missed no refresh, but it would with refreshes 5 % shorter.
  bool narrow = false;
  // Share of the wire for the requested refreshes; above 1: number of wires.
  double planned_load = 0;
  double load = 0;     // share of the wire used in the run
  double stretch = 1;  // factor on all refreshes under overload
  Duration horizon{};  // duration of the run in virtual time
  std::uint64_t reads = 0, missed = 0;
  std::vector<PointForecast> points;  // in the order of the input
  std::vector<BlockForecast> blocks;  // the 1 000 most frequent, by device and address
  ReadPlan plan;                      // at the end of the run
  Remedies remedies;                  // empty if feasible
};

[[nodiscard]] Prediction predict(const ScheduleInput& input, const PredictionOptions& options = {});

}  // namespace fieldcast

// What a bus will do before it does it: the scheduler itself, run in virtual time over an ideal wire.
//
// Deterministic, no clock; a few hundred milliseconds of work at most. For `fieldcast plan`, and for the check of a
// configuration.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/schedule/scheduler.hpp"

namespace fieldcast {

struct PredictionOptions {
  Duration horizon{};                 // virtual time; 0: three times the longest refresh, at least 60 s and at most an hour
  std::uint64_t max_reads = 100'000;  // the run ends here at the latest
  bool remedies = true;               // when infeasible, look for what would work
  Planner planner = Planner::kRiding;
};

// What one point will get.
struct PointForecast {
  Duration refresh{};    // as wished
  Duration worst_gap{};  // between two samples; the whole run if it was read less than twice
  std::uint64_t reads = 0;
  std::uint64_t missed = 0;  // gaps longer than the refresh
};

// One block as it will be seen on the wire; those of the riding planner vary, so each shape stands for itself.
struct BlockForecast {
  DeviceIndex device = 0;
  std::vector<Range> ranges;
  std::size_t points = 0;
  Duration cost{};  // of the wire
  double per_second = 0;
};

// Points of one refresh and the refresh that they would need.
struct SlowerPoints {
  Duration from{}, to{};
  std::vector<PointIndex> points;
};

// The nearest configurations that work; nothing where none was found.
struct Remedies {
  std::optional<double> stretch;      // all refreshes longer by this factor
  std::optional<std::uint32_t> baud;  // the next standard rate
  std::vector<SlowerPoints> slower;   // only the fastest points slower, as far as needed: all of these together
  bool longer_reads = false;          // devices without the max-block and max-gap that are configured
  bool no_pause = false;              // devices without their pause
  std::optional<std::size_t> buses;   // the devices spread over so many lines of this kind
};

struct Prediction {
  bool feasible = false;    // nothing is read later than its refresh allows, now or in a longer run
  bool narrow = false;      // not feasible, though this run missed nothing: with refreshes 5 % shorter it would have
  double planned_load = 0;  // share of the wire that the wished refreshes need; how many wires, above 1
  double load = 0;          // share of the wire that the run used
  double stretch = 1;       // factor on all refreshes by which overload is met
  Duration horizon{};       // virtual time that was run
  std::uint64_t reads = 0, missed = 0;
  std::vector<PointForecast> points;  // in the order of the input
  std::vector<BlockForecast> blocks;  // by device and address; at most 1 000, the most frequent
  Remedies remedies;                  // empty when feasible
};

// The same with every refresh longer by the factor; on a faster line (nothing: it is as fast already).
[[nodiscard]] ScheduleInput stretched(const ScheduleInput& input, double factor);
inline constexpr std::array<std::uint32_t, 10> kStandardRates{2400,  4800,   9600,   19200,  38400,
                                                              57600, 115200, 230400, 460800, 921600};
[[nodiscard]] std::optional<ScheduleInput> at_rate(const ScheduleInput& input, std::uint32_t baud);

[[nodiscard]] Prediction predict(const ScheduleInput& input, const PredictionOptions& options = {});

}  // namespace fieldcast

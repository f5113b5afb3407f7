// Measures the scheduler in virtual time: sustained load without a missed refresh, wire usage, cost
// of a decision.
//
// usage: schedule_bench [sustained] [spent] [decision] [intensive] [mixed] [agree] [engine]
//        (default: all)
//        schedule_bench mixed FIRST_SEED
//        schedule_bench agree|engine FIRST_SEED MAPS
//        schedule_bench losses FIRST_SEED MAPS 1|0   (1: whole engine, 0: scheduler alone)
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/dispatch/scheduler.hpp"
#include "core/plan/layout/partition.hpp"
#include "core/protocol/families/registry.hpp"
#include "core/schedule/prediction.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/engine_agreement.hpp"
#include "tools/progress/progress_line.hpp"

namespace {

using namespace fieldcast;
using namespace std::chrono_literals;

const test::FakeProtocol kProtocol;
constexpr std::uint32_t kBaud = 19200;

struct Spent {
  std::uint64_t missed = 0;
  double load = 0, planned = 0;
};

Spent run(const test::Map& map, Planner planner, Duration delay, double stretch, Duration length) {
  const ScheduleInput input = test::input_of(map, kProtocol, kBaud, delay, stretch);
  const auto scheduler = make_scheduler(input, planner);
  test::VirtualWire wire(input, *scheduler);
  const Instant end = wire.now() + length;
  while (wire.now() < end && wire.missed() == 0) wire.run(length / 60);
  return {wire.missed() + wire.overdue(), wire.load(), scheduler->planned_load()};
}

// The highest share of the bound without a missed refresh in half an hour.
double sustained(const test::Map& map, Planner planner, Duration delay, StepProgress& progress) {
  const double least = test::least_load(map, kBaud, delay);
  return bench::greatest_share(1.0, progress, [&](double share) {
    return run(map, planner, delay, least / share, 30min).missed == 0;
  });
}

void print_sustained() {
  std::puts(
      "sustained load, share of the least any master needs, 30 min without a missed refresh, 19200 "
      "baud;\n"
      "at most: what the tighter bound leaves possible (tests/plan/maps.hpp)");
  fmt::print("{:10} {:>6}", "map", "delay");
  const Planner planners[] = {Planner::kCyclic, Planner::kDynamicBlocks, Planner::kFastestMember,
                              Planner::kOnePerChannel};
  for (const Planner planner : planners) fmt::print(" {:>15}", to_text(planner));
  fmt::print(" {:>12} {:>15}\n", "at most", "cyclic of that");
  double sum[4] = {}, most_sum = 0, share_sum = 0;
  StepProgress progress("sustained load", 4 * 2 * 4 * bench::trials_below(1.0));
  for (const int number : {11, 12, 13, 14}) {
    const test::Map map =
        test::read_map(std::string(FIELDCAST_MAPS) + "/map" + std::to_string(number) + ".csv");
    for (const Duration delay : {Duration{0}, Duration{5ms}}) {
      std::string row = fmt::format("map{:<7} {:4.0f}ms", number, to_seconds(delay) * 1e3);
      const double most =
          test::least_load(map, kBaud, delay) / test::proven_load(map, kBaud, delay);
      double cyclic = 0;
      for (std::size_t i = 0; i < std::size(planners); ++i) {
        const double load = sustained(map, planners[i], delay, progress);
        sum[i] += load / 8;
        if (planners[i] == Planner::kCyclic) cyclic = load;
        row += fmt::format(" {:15.3f}", load);
      }
      most_sum += most / 8;
      share_sum += cyclic / most / 8;
      progress.clear();
      fmt::print("{} {:12.3f} {:15.3f}\n", row, most, cyclic / most);
      std::fflush(stdout);
    }
  }
  fmt::print("{:17}", "average");
  for (const double load : sum) fmt::print(" {:15.3f}", load);
  fmt::print(" {:12.3f} {:15.3f}\n\n", most_sum, share_sum);
}

void print_spent() {
  fmt::print("wire time in scheduled mode at half the bound's load, against the plan's own\n");
  StepProgress progress("spent wire time", 8);
  for (const int number : {11, 12, 13, 14}) {
    const test::Map map =
        test::read_map(std::string(FIELDCAST_MAPS) + "/map" + std::to_string(number) + ".csv");
    for (const Duration delay : {Duration{0}, Duration{5ms}}) {
      const Spent spent =
          run(map, Planner::kCyclic, delay, test::least_load(map, kBaud, delay) / 0.5, 30min);
      progress.step();
      progress.clear();
      fmt::print("map{:<7} {:4.0f}ms  planned {:.3f}  spent {:.3f}  ratio {:.3f}  missed {}\n",
                 number, to_seconds(delay) * 1e3, spent.planned, spent.load,
                 spent.load / spent.planned, spent.missed);
    }
  }
  fmt::print("\n");
}

// Of this thread, so that other processes do not count.
Duration processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds{time.tv_sec} + Duration{time.tv_nsec};
}

void print_decision() {
  constexpr std::uint64_t kDecisions = 50'000, kStep = 1000;
  fmt::print(
      "cost of a decision (next and acquired) and of building, random maps at a load of about "
      "0.5\n");
  for (const std::size_t channels : {300u, 1000u, 10'000u}) {
    const test::Map map = test::random_map(5, channels, 30);
    const ScheduleInput input =
        test::input_of(map, kProtocol, kBaud, {}, test::least_load(map, kBaud) / 0.5);
    const Duration before = processor_time();
    const auto scheduler = make_scheduler(input);
    const Duration built = processor_time();
    test::VirtualWire wire(input, *scheduler);
    wire.run(60s);
    wire.forget_gaps();
    std::uint64_t decisions = 0;
    std::vector<Duration> took;
    Duration total{};
    Instant now = wire.now();
    StepProgress progress(fmt::format("decisions of {} channels", channels), kDecisions / kStep);
    while (decisions < kDecisions) {
      const Duration began = processor_time();
      const Decision decision = scheduler->next(now);
      if (const auto* block = std::get_if<Block>(&decision)) {
        now += block->cost;
        scheduler->acquired(*block, now - input.silence);
      } else {
        now = std::get<Rest>(decision).until;
      }
      took.push_back(processor_time() - began);
      replan(*scheduler, now);  // runs on another thread in a bridge
      total += took.back();
      if (++decisions % kStep == 0) progress.step();
    }
    progress.clear();
    std::ranges::sort(took);
    std::printf(
        "%6zu channels: build %6.1f ms, decision %5.2f us on average, %6.1f us in 999 of 1000\n",
        channels, std::chrono::duration<double, std::milli>(built - before).count(),
        to_seconds(total) * 1e6 / static_cast<double>(decisions),
        to_seconds(took[took.size() * 999 / 1000]) * 1e6);
  }
  fmt::print("\n");
}

void print_intensive() {
  std::puts(
      "intensive mode, 300 scattered registers in 3 units, 115200 baud, 2 ms responses: against a "
      "loop over the optimal partition");
  ScheduleInput input = test::input_of(test::random_map(7, 300), kProtocol, 115200, 2ms);
  Duration loop{};
  for (DeviceIndex device = 0; device < 3; ++device) {
    std::vector<Wanted> wanted;
    for (Point& point : input.points) {
      point.refresh = 1s;
      point.mode = Mode::kIntensive;
      if (point.device == device) wanted.push_back({point.range.first, point.range.end()});
    }
    const ReadCost cost(input.devices[device], test::kRegisters, input.line, input.silence, 65000);
    loop += cost_of(wanted, optimal_partition(wanted, cost), cost);
  }
  const auto scheduler = make_scheduler(input);
  test::VirtualWire wire(input, *scheduler);
  wire.run(10s);
  wire.forget_gaps();
  wire.run(60s);
  double refreshes = 0;
  Duration longest{}, shortest = Duration::max();
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    refreshes += static_cast<double>(wire.seen(point).count);
    longest = std::max(longest, wire.seen(point).longest);
    shortest = std::min(shortest, wire.seen(point).shortest);
  }
  fmt::print(
      "refreshes a second {:.0f}, the loop {:.0f}, ratio {:.4f}; longest gap / shortest {:.3f}\n\n",
      refreshes / 60, 300 / to_seconds(loop), refreshes / 60 / (300 / to_seconds(loop)),
      to_seconds(longest) / to_seconds(shortest));
}

// Two to six units, up to four protocols, refreshes from 100 ms to 10 s, and a planned load from a
// quarter of the wire to all of it.
struct MixedBus {
  std::vector<std::unique_ptr<Protocol>> protocols;
  ScheduleInput input;
};
MixedBus mixed_bus(std::uint64_t seed) {
  struct Family {
    const char* name;
    std::map<std::string, std::string> options;
    const char* areas[2];
    std::uint32_t items[2];  // maximum of one point
    std::uint32_t end;       // end of the addresses in the second area
  };
  static const Family families[] = {
      {"modbus-rtu", {}, {"holding:", "coil:"}, {2, 1}, 2000},
      {"s7-ppi", {}, {"VB", "MB"}, {4, 1}, 30},
      {"omron-hostlink", {{"mode", "fins"}}, {"DM", "W"}, {2, 1}, 500},
      {"dtc", {}, {"int16:", "int32:"}, {2, 1}, 2000}};
  constexpr int kRefreshes[] = {100, 200, 500, 1000, 2000, 5000, 10'000};
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  MixedBus bus;
  bus.input.line = LineFormat{below(2) ? 19200u : 115200u, 8, Parity::kEven, 1};
  bus.input.silence = silence_of(StandardSilence{}, bus.input.line);
  const std::uint32_t units = 2 + below(5);
  for (DeviceIndex device = 0; device < units; ++device) {
    const Family& family = families[below(4)];
    bus.protocols.push_back(*find_protocol(family.name)
                                 ->make({.address = static_cast<std::uint16_t>(device + 1),
                                         .options = family.options,
                                         .line = bus.input.line}));
    bus.input.devices.push_back({.protocol = bus.protocols.back().get(),
                                 .response_time = std::chrono::microseconds{500 + below(10'000)}});
    const std::uint32_t points = 10 + below(50);
    for (std::uint32_t i = 0, at = below(20); i < points;
         ++i, at += below(6) == 0 ? 12 + below(60) : 1 + below(4)) {
      const bool second = below(4) == 0;
      const auto first = bus.protocols.back()->parse_address(
          family.areas[second] + std::to_string(second ? at % family.end : at));
      if (!first) throw std::runtime_error(first.error().what);
      bus.input.points.push_back({device,
                                  {first->area, first->first, 1 + below(family.items[second])},
                                  std::chrono::milliseconds{kRefreshes[below(7)]}});
    }
  }
  const double planned = make_scheduler(bus.input)->planned_load(),
               wanted = 0.25 + 0.01 * below(75);
  for (Point& point : bus.input.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * planned / wanted);
  return bus;
}

void print_mixed(std::uint64_t first) {
  std::puts(
      "200 random buses of several units, areas and protocols: what plan said of them, and ten "
      "times as long a run");
  struct Row {
    int buses = 0, feasible = 0, missing = 0;
    std::uint64_t reads = 0, missed = 0;
  };
  std::map<int, Row> rows;  // by planned load, in tenths
  double farthest = 0;
  StepProgress progress("random buses", 200);
  for (std::uint64_t seed = first; seed < first + 200; ++seed, progress.step()) {
    const MixedBus bus = mixed_bus(seed);
    const Prediction prediction = predict(bus.input, {.remedies = false});
    Row& row = rows[static_cast<int>(prediction.planned_load * 10)];
    ++row.buses;
    if (!prediction.feasible) continue;
    ++row.feasible;
    const auto scheduler = make_scheduler(bus.input);
    test::VirtualWire wire(bus.input, *scheduler);
    wire.run(10 * prediction.horizon);
    row.reads += wire.blocks();
    row.missed += wire.missed();
    row.missing += wire.missed() + wire.overdue() > 0;
    farthest = std::max(farthest, std::abs(wire.load() / prediction.load - 1));
    if (wire.missed() == 0) continue;
    progress.clear();
    fmt::print("  seed {}: planned {:.3f}, {} misses in {:.0f} s\n", seed, prediction.planned_load,
               wire.missed(), to_seconds(10 * prediction.horizon));
  }
  progress.clear();
  fmt::print("planned load   buses  feasible  of these with a miss   reads       misses\n");
  for (const auto& [tenth, row] : rows)
    fmt::print("{:.1f} to {:.1f} {:11} {:9} {:21} {:9} {:10}\n", tenth / 10.0, (tenth + 1) / 10.0,
               row.buses, row.feasible, row.missing, row.reads, row.missed);
  fmt::print("the measured load is at most {:.1f} % away from the predicted one\n\n",
             100 * farthest);
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Arguments arguments(argc, argv);
  const auto wanted = [&](std::string_view name) {
    return arguments.size() == 0 || arguments.has(name);
  };
  if (wanted("intensive")) print_intensive();
  if (wanted("decision")) print_decision();
  if (wanted("spent")) print_spent();
  if (wanted("mixed")) print_mixed(arguments.number_at(1, std::uint64_t{1}));
  if (wanted("sustained")) print_sustained();
  if (wanted("agree"))
    bench::print_agreement(arguments.number_at(1, 1u), arguments.number_at(2, 100u));
  if (arguments.has("losses"))
    bench::print_losses(arguments.number_at(1, 11u), arguments.number_at(2, 5u),
                        arguments.number_at(3, 1u) != 0);
  if (wanted("engine"))
    bench::print_engine(arguments.number_at(1, 101u), arguments.number_at(2, 10u));
}

#include "tools/bench/support/engine_agreement.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>

#include "config/loader/loader.hpp"
#include "core/plan/layout/partition.hpp"
#include "core/plan/planner.hpp"
#include "core/plan/wire_model.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"
#include "tools/cli/model/bus_plan.hpp"

namespace fieldcast::bench {

namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kBaud = 19200;
constexpr Duration kSilence = 2'005'208ns;  // 3.5 characters: the minimum time before a response
constexpr std::size_t kChannels = 300;
constexpr double kMost = 1.0;  // share of the bound

BridgeSpec load(const test::Map& map, double stretch, const test::Notation& notation = {}) {
  auto loaded = config::load_text(test::configuration_of(map, stretch, kBaud, notation), "map.yaml",
                                  {}, {.refuse_hopeless = false});
  if (!loaded) throw std::runtime_error(config::to_text(loaded.error()));
  return *std::move(loaded);
}

// The bound counts the response time from the end of the request's silence.
double bound(const test::Map& map, Duration response) {
  return test::least_load(map, kBaud, response - kSilence);
}

std::uint64_t missed(const test::Map& map, Duration response, double share, Duration length) {
  const BridgeSpec spec = load(map, bound(map, response) / share);
  cli::BusPlan plan;  // its prediction is not needed
  plan.bus = &spec.buses[0];
  plan.response_time = response;
  return cli::simulate(plan, {}, {length, 1}).bus.deadline_misses;
}

std::uint64_t scheduler_missed(const test::Map& map, Duration response, double share,
                               Duration length) {
  const test::FakeProtocol protocol;
  const ScheduleInput input =
      test::input_of(map, protocol, kBaud, response - kSilence, bound(map, response) / share);
  const auto scheduler = make_scheduler(input);
  test::VirtualWire wire(input, *scheduler);
  wire.run(length);
  return wire.missed() + wire.overdue();
}

struct Agreement {
  unsigned runs = 0, feasible = 0, disagree = 0, careful = 0;

  bool add(const BridgeSpec& spec, Duration response) {
    const cli::BusPlan plan = cli::make_plan(spec.buses[0], response);
    const std::uint64_t late = cli::simulate(plan, {}, {20min, 1}).bus.deadline_misses;
    const bool promised = plan.prediction.feasible;
    ++runs;
    feasible += promised ? 1 : 0;
    careful += !promised && late == 0 ? 1 : 0;
    disagree += promised && late > 0 ? 1 : 0;
    return !promised || late == 0;
  }
  void print(const char* of) const {
    std::printf("%-16s %4u runs, %4u feasible, of these %2u with a miss; %2u too careful\n", of,
                runs, feasible, disagree, careful);
    std::fflush(stdout);
  }
};

// Scales refreshes to a planned load of 0.45 to 0.84 of the wire.
double stretch_of(const test::Map& map, const test::Notation& notation, std::uint64_t seed,
                  Duration response) {
  constexpr double kRoomy = 4;
  const BridgeSpec spec = load(map, kRoomy, notation);
  const auto load =
      planned_load_of(cli::make_plan(spec.buses[0], response).input, Planner::kCyclic).load;
  return kRoomy * load / (0.45 + 0.01 * static_cast<double>(seed * 7 % 40));
}

}  // namespace

void print_agreement(std::uint64_t first_seed, unsigned maps) {
  std::printf(
      "%u random maps of %zu registers at 0.30 to 0.69 of the bound: plan, and 20 minutes of the "
      "engine\n",
      maps, kChannels);
  const auto report = [](StepProgress& progress, const char* of, std::uint64_t seed,
                         Duration response) {
    progress.clear();
    std::printf("  %s, seed %llu, responses after %.0f ms: called feasible, and missed\n", of,
                static_cast<unsigned long long>(seed), to_seconds(response) * 1e3);
  };
  constexpr Duration kResponses[] = {Duration{0}, Duration{2ms}, Duration{5ms}, Duration{20ms}};
  StepProgress maps_done("random maps", std::size(kResponses) * maps);
  for (const Duration response : kResponses) {
    Agreement all;
    for (std::uint64_t seed = first_seed; seed < first_seed + maps; ++seed, maps_done.step()) {
      const test::Map map = test::random_map(seed, kChannels);
      const double share = 0.30 + 0.01 * static_cast<double>(seed * 7 % 40);
      if (!all.add(load(map, bound(map, response) / share), response))
        report(maps_done, "modbus", seed, response);
    }
    maps_done.clear();
    all.print(("modbus, " + to_text(response)).c_str());
  }
  std::puts("a tenth as many of 60 registers in other families, 0.45 to 0.84 of the wire");
  const unsigned tenth = (maps + 9) / 10;
  StepProgress others_done("maps of other families", 4 * tenth * std::size(kResponses));
  for (const test::Notation notation :
       {test::Notation{"s7-ppi", "VW", 2}, test::Notation{"omron-hostlink", "DM", 1},
        test::Notation{"dtc", "int16:", 1}, test::Notation{"mitsubishi-fx", "D", 1}}) {
    Agreement all;
    for (std::uint64_t seed = first_seed; seed < first_seed + tenth; ++seed) {
      const bool one = std::string_view(notation.protocol) == "mitsubishi-fx";
      const test::Map map = test::random_map(seed, 60, one ? 1 : 3);
      for (const Duration response : kResponses) {
        const double stretch = stretch_of(map, notation, seed, response);
        if (!all.add(load(map, stretch, notation), response))
          report(others_done, notation.protocol, seed, response);
        others_done.step();
      }
    }
    others_done.clear();
    all.print(notation.protocol);
  }
  std::puts("");
}

void print_engine(std::uint64_t first_seed, unsigned maps) {
  std::puts(
      "sustained load of the whole engine, share of the bound, 10 min without a missed refresh, "
      "its start included;\n"
      "beside it the scheduler alone, which knows the response time from the start");
  StepProgress progress("sustained load", 3 * 2 * maps * trials_below(kMost));
  for (const Duration response : {kSilence, Duration{5ms}, kSilence + 5ms}) {
    double engine = 0, alone = 0, least = 1;
    for (std::uint64_t seed = first_seed; seed < first_seed + maps; ++seed) {
      const test::Map map = test::random_map(seed, kChannels);
      const double whole = greatest_share(
          kMost, progress, [&](double share) { return missed(map, response, share, 10min) == 0; });
      engine += whole / maps;
      least = std::min(least, whole);
      const double scheduler = greatest_share(kMost, progress, [&](double share) {
        return scheduler_missed(map, response, share, 10min) == 0;
      });
      alone += scheduler / maps;
    }
    progress.clear();
    std::printf("responses after %.3f ms: engine %.3f on average, %.3f at worst; scheduler %.3f\n",
                to_seconds(response) * 1e3, engine, least, alone);
    std::fflush(stdout);
  }
  std::puts("");
}

namespace {

// Seeds 11 to 15 are the maps of tests/maps.
test::Map map_of(std::uint64_t seed) {
  if (seed < 11 || seed > 15) return test::random_map(seed, kChannels);
  return test::read_map(std::string(FIELDCAST_MAPS) + "/map" + std::to_string(seed) + ".csv");
}

// Loads from the bound to the timetable. Each step adds the cause that it is named after.
struct Steps {
  double bound = 0, margin = 0, periods = 0, split = 0, table = 0;
};

// The bound of proven_load() for the given refreshes. Points of different parts share no read.
double bound_for(const WireModel& wire, std::span<const PlannedPoint> points,
                 const std::function<double(OrderIndex)>& refresh,
                 const std::function<std::uint32_t(OrderIndex)>& part) {
  std::map<std::uint32_t, std::map<double, std::vector<OrderIndex>>> parts;
  for (OrderIndex i = 0; i < points.size(); ++i) parts[part(i)][refresh(i)].push_back(i);
  double load = 0;
  for (const auto& [name, classes] : parts) {
    std::set<OrderIndex> wanted;
    double before = 0;
    for (const auto& [seconds, members] : classes) {
      wanted.insert(members.begin(), members.end());
      std::vector<Wanted> ranges;
      for (const OrderIndex i : wanted) ranges.push_back({points[i].first, points[i].end});
      const ReadCost& cost = wire.layout.area_runs[wire.layout.area_run_at[*wanted.begin()]].cost;
      const double all = to_seconds(cost_of(ranges, optimal_partition(ranges, cost), cost));
      load += (all - before) / seconds;
      before = all;
    }
  }
  return load;
}

Steps steps_of(const test::Map& map, Duration response, double share) {
  const test::FakeProtocol protocol;
  const ScheduleInput input =
      test::input_of(map, protocol, kBaud, response - kSilence, bound(map, response) / share);
  const WireModel wire(input, Planner::kCyclic);
  const auto points = planned_points(input, wire.layout);
  const auto scheduler = make_scheduler(input);
  const ReadPlan& plan = scheduler->plan();
  const auto of_run = [&](OrderIndex i) { return wire.layout.area_run_at[i]; };
  const auto refresh = [&](OrderIndex i) { return to_seconds(points[i].refresh); };
  const double margin = wire.weights.margin + plan.lightness * wire.weights.light_reserve;
  const auto gap = [&](OrderIndex i) {
    return to_seconds(allowed_gap_of(ns(points[i].refresh), wire.lead)) * (1 - margin);
  };
  const auto period = [&](OrderIndex i) { return to_seconds(plan.points[i].period); };
  const auto of_group = [&](OrderIndex i) { return plan.grouping.group_at[i]; };
  return {bound_for(wire, points, refresh, of_run), bound_for(wire, points, gap, of_run),
          bound_for(wire, points, period, of_run), bound_for(wire, points, period, of_group),
          plan.table->load()};
}

}  // namespace

void print_losses(std::uint64_t first_seed, unsigned maps, bool engine) {
  std::puts(
      "share of what any master can sustain, 30 min without a missed refresh, and the share of the "
      "wire lost to each cause");
  std::printf("%-10s %9s %7s %7s | %7s %8s %7s %7s %7s\n", "map", "response", "engine", "alone",
              "margin", "periods", "split", "phases", "rests");
  StepProgress progress("losses", 3 * maps * trials_below(kMost));
  for (const Duration response : {Duration{1us}, Duration{5ms}, Duration{20ms}}) {
    double sum = 0, least = 1, sum_alone = 0, least_alone = 1;
    for (std::uint64_t seed = first_seed; seed < first_seed + maps; ++seed) {
      const test::Map map = map_of(seed);
      const double most = bound(map, response) / test::proven_load(map, kBaud, response - kSilence);
      const auto greatest = [&](const auto& misses) {
        return greatest_share(kMost, progress, [&](double share) {
          return misses(map, response, share * most, 30min) == 0;
        });
      };
      const double alone = greatest(scheduler_missed);
      const double whole = engine ? greatest(missed) : 0;
      const Steps at = steps_of(map, response, alone * most);
      progress.clear();
      std::printf("%-10s %7.3fms %7.3f %7.3f | %7.3f %8.3f %7.3f %7.3f %7.3f\n",
                  std::to_string(seed).c_str(), to_seconds(response) * 1e3, whole, alone,
                  at.margin - at.bound, at.periods - at.margin, at.split - at.periods,
                  at.table - at.split, 1 - at.table);
      std::fflush(stdout);
      sum += whole / maps, least = std::min(least, whole);
      sum_alone += alone / maps, least_alone = std::min(least_alone, alone);
    }
    std::printf(
        "responses after %.3f ms: engine %.4f on average, %.3f at worst; alone %.4f, %.3f\n",
        to_seconds(response) * 1e3, sum, least, sum_alone, least_alone);
    std::fflush(stdout);
  }
}

}  // namespace fieldcast::bench

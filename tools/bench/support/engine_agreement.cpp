#include "tools/bench/support/engine_agreement.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string_view>

#include "config/loader/loader.hpp"
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

}  // namespace fieldcast::bench

// Figures of the scheduler in virtual time: the load it sustains without a missed refresh, what it spends, what a decision costs.
//
// usage: schedule_bench [sustained] [spent] [decision] [intensive]     (all of them without an argument)
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string_view>
#include <vector>

#include "core/plan/partition.hpp"
#include "core/schedule/scheduler.hpp"
#include "tests/schedule/maps.hpp"
#include "tests/schedule/virtual_wire.hpp"

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

// The highest share of the bound at which half an hour passes without a missed refresh.
double sustained(const test::Map& map, Planner planner, Duration delay) {
  const double least = test::least_load(map, kBaud, delay);
  double holds = 0.05, fails = 1.0;
  while (fails - holds > 0.004) {
    const double load = (holds + fails) / 2;
    (run(map, planner, delay, least / load, 30min).missed == 0 ? holds : fails) = load;
  }
  return holds;
}

void print_sustained() {
  std::puts(
      "sustained load, share of the least any master needs, 30 min without a missed refresh, 19200 baud;\n"
      "at most: what the tighter bound leaves possible (tests/schedule/maps.hpp)");
  std::printf("%-10s %6s", "map", "delay");
  const Planner planners[] = {Planner::kRiding, Planner::kDynamicBlocks, Planner::kFastestMember, Planner::kOnePerChannel};
  for (const Planner planner : planners) std::printf(" %15s", std::string(to_text(planner)).c_str());
  std::printf(" %12s %15s\n", "at most", "riding of that");
  double sum[4] = {}, most_sum = 0, share_sum = 0;
  for (const int number : {11, 12, 13, 14}) {
    const test::Map map = test::read_map(std::string(FIELDCAST_MAPS) + "/map" + std::to_string(number) + ".csv");
    for (const Duration delay : {Duration{0}, Duration{5ms}}) {
      std::printf("map%-7d %4.0fms", number, to_seconds(delay) * 1e3);
      const double most = test::least_load(map, kBaud, delay) / test::proven_load(map, kBaud, delay);
      double riding = 0;
      for (std::size_t i = 0; i < std::size(planners); ++i) {
        const double load = sustained(map, planners[i], delay);
        sum[i] += load / 8;
        if (planners[i] == Planner::kRiding) riding = load;
        std::printf(" %15.3f", load);
        std::fflush(stdout);
      }
      most_sum += most / 8;
      share_sum += riding / most / 8;
      std::printf(" %12.3f %15.3f\n", most, riding / most);
    }
  }
  std::printf("%-17s", "average");
  for (const double load : sum) std::printf(" %15.3f", load);
  std::printf(" %12.3f %15.3f\n\n", most_sum, share_sum);
}

void print_spent() {
  std::puts("wire time in scheduled mode at half the bound's load, against the plan's own");
  for (const int number : {11, 12, 13, 14}) {
    const test::Map map = test::read_map(std::string(FIELDCAST_MAPS) + "/map" + std::to_string(number) + ".csv");
    for (const Duration delay : {Duration{0}, Duration{5ms}}) {
      const Spent spent = run(map, Planner::kRiding, delay, test::least_load(map, kBaud, delay) / 0.5, 30min);
      std::printf("map%-7d %4.0fms  planned %.3f  spent %.3f  ratio %.3f  missed %llu\n", number, to_seconds(delay) * 1e3,
                  spent.planned, spent.load, spent.load / spent.planned, static_cast<unsigned long long>(spent.missed));
    }
  }
  std::puts("");
}

// Of this thread: others on the machine do not count.
Duration processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds{time.tv_sec} + Duration{time.tv_nsec};
}

void print_decision() {
  std::puts("cost of a decision (next and acquired) and of building, random maps at a load of about 0.5");
  for (const std::size_t channels : {300u, 1000u, 10'000u}) {
    const test::Map map = test::random_map(5, channels, 30);
    const ScheduleInput input = test::input_of(map, kProtocol, kBaud, {}, test::least_load(map, kBaud) / 0.5);
    const auto before = std::chrono::steady_clock::now();
    const auto scheduler = make_scheduler(input);
    const auto built = std::chrono::steady_clock::now();
    test::VirtualWire wire(input, *scheduler);
    wire.run(60s);
    wire.forget_gaps();
    std::uint64_t decisions = 0;
    std::vector<Duration> took;
    Duration total{};
    Instant now = wire.now();
    while (decisions < 50'000) {
      const Duration asked = processor_time();
      const Decision decision = scheduler->next(now);
      if (const auto* block = std::get_if<Block>(&decision)) {
        now += block->cost;
        scheduler->acquired(*block, now - input.silence);
      } else {
        now = std::get<Rest>(decision).until;
      }
      took.push_back(processor_time() - asked);
      total += took.back();
      ++decisions;
    }
    std::sort(took.begin(), took.end());
    std::printf("%6zu channels: build %6.1f ms, decision %5.2f us on average, %6.1f us in 999 of 1000\n", channels,
                std::chrono::duration<double, std::milli>(built - before).count(),
                to_seconds(total) * 1e6 / static_cast<double>(decisions), to_seconds(took[took.size() * 999 / 1000]) * 1e6);
  }
  std::puts("");
}

void print_intensive() {
  std::puts(
      "intensive mode, 300 scattered registers in 3 units, 115200 baud, 2 ms answers: against a loop over the optimal partition");
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
  std::printf("refreshes a second %.0f, the loop %.0f, ratio %.4f; longest gap / shortest %.3f\n\n", refreshes / 60,
              300 / to_seconds(loop), refreshes / 60 / (300 / to_seconds(loop)), to_seconds(longest) / to_seconds(shortest));
}

}  // namespace

int main(int argc, char** argv) {
  const auto wanted = [&](std::string_view name) {
    for (int i = 1; i < argc; ++i) {
      if (name == argv[i]) return true;
    }
    return argc == 1;
  };
  if (wanted("intensive")) print_intensive();
  if (wanted("decision")) print_decision();
  if (wanted("spent")) print_spent();
  if (wanted("sustained")) print_sustained();
}

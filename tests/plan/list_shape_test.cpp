// Reads by lists of ranges, for random states of their points, compared with the rules of
// read_selector.hpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/plan/planner.hpp"
#include "core/plan/shape/read_selector.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Instant kNow{100s};

// One device whose points share requests, and the group that has most of them.
struct ListedDevice {
  ListedDevice(const char* name, std::map<std::string, std::string> options,
               const std::vector<std::pair<std::string, std::uint32_t>>& points,
               std::uint16_t max_block = 0) {
    input.line = LineFormat{19200, 8, Parity::kEven, 1};
    protocol = *find_protocol(name)->make(
        {.address = 1, .options = std::move(options), .line = input.line});
    input.silence = 2ms;
    input.devices.push_back(
        {.protocol = protocol.get(), .response_time = 5ms, .max_block = max_block});
    for (const auto& [at, items] : points) {
      const auto parsed = protocol->parse_address(at);
      if (!parsed) throw std::runtime_error(at + ": " + parsed.error().what);
      input.points.push_back({0, {parsed->area, parsed->first, items}, 1s});
    }
    wire = std::make_unique<WireModel>(input, Planner::kCyclic);
    const PlanBasis basis{*wire, planned_points(input, wire->layout), 1, {}};
    for (const Group& each : group_points(basis).groups) {
      if (each.list && each.end - each.begin > group.end - group.begin) group = each;
    }
    for (OrderIndex at = group.begin; at < group.end; ++at) {
      PointState& state = states.emplace_back(PointState{basis.points[at]});
      state.eager = false;
      state.allowed_gap = 998ms;
      state.due = state.deadline = kNow + 10s + Duration{at};
    }
  }
  [[nodiscard]] const ListCost& cost() const { return *wire->layout.lists[0]; }
  [[nodiscard]] const Selection& select(ReadSelector& selector, std::uint32_t urgent,
                                        const Allowance& allowance = {}) const {
    return selector.select(wire->layout, group, states, urgent, kNow, allowance);
  }
  [[nodiscard]] std::uint32_t index_of(std::uint32_t first) const {
    const auto found = std::ranges::find(states, first, &PointState::first);
    return static_cast<std::uint32_t>(found - states.begin());
  }

  ScheduleInput input;
  std::unique_ptr<Protocol> protocol;
  std::unique_ptr<WireModel> wire;
  Group group;
  std::vector<PointState> states;
};

ListedDevice words_of_fins() {
  std::vector<std::pair<std::string, std::uint32_t>> points;
  for (const unsigned at : {0, 1, 3, 4}) points.emplace_back("DM" + std::to_string(at), 1);
  for (unsigned i = 0; i < 12; ++i) points.emplace_back("DM" + std::to_string(900 * (i + 1)), 1);
  return {"omron-hostlink", {{"mode", "fins"}}, points};
}

// FINS reads one range by a shorter command than a list.
TEST(ListShape, NearWordsAreReadByOneRange) {
  ListedDevice device = words_of_fins();
  ASSERT_GE(device.states.size(), 16u);
  ReadSelector selector(ShapeRule::kCyclic);
  const std::uint32_t first = device.index_of(0);
  for (const std::uint32_t at : {0u, 1u, 3u, 4u})
    device.states[device.index_of(at)].due = kNow + Duration{at};
  const Selection& read = device.select(selector, first);
  ASSERT_EQ(read.ranges().size(), 1u);
  EXPECT_EQ(read.ranges()[0].first, 0u);
  EXPECT_EQ(read.ranges()[0].count, 5u);
  EXPECT_EQ(read.members.size(), 4u);
}

TEST(ListShape, NoRangeHoldsAWordThatTheDeviceRefuses) {
  ListedDevice device = words_of_fins();
  ReadSelector selector(ShapeRule::kCyclic);
  const std::uint32_t first = device.index_of(0);
  for (const std::uint32_t at : {0u, 1u, 3u, 4u})
    device.states[device.index_of(at)].due = kNow + Duration{at};
  device.states[device.index_of(3)].bad = true;
  const Selection& read = device.select(selector, first);
  for (const Range& range : read.ranges())
    EXPECT_FALSE(range.first <= 3 && 3 < range.end()) << range.first;
  EXPECT_EQ(read.members.size(), 3u);
}

TEST(ListShape, ARefusedWordBeforeTheOthersDoesNotSeparateThem) {
  ListedDevice device = words_of_fins();
  ReadSelector selector(ShapeRule::kCyclic);
  const std::uint32_t urgent = device.index_of(1);
  for (const std::uint32_t at : {1u, 3u, 4u})
    device.states[device.index_of(at)].due = kNow + Duration{at};
  device.states[device.index_of(0)].bad = true;
  const Selection& read = device.select(selector, urgent);
  ASSERT_EQ(read.ranges().size(), 1u);
  EXPECT_EQ(read.ranges()[0].first, 1u);
  EXPECT_EQ(read.ranges()[0].count, 4u);
}

struct Built {
  std::vector<Range> ranges;
  Duration cost{};
};

// The cheaper of a list and one range over all points, if no refused point is between them.
std::optional<Built> built_of(const ListedDevice& device, const std::vector<bool>& taken) {
  const auto& states = device.states;
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t at = 0; at < states.size(); ++at) {
    if (taken[at]) chosen.push_back(at);
  }
  const auto refused_between = [&](std::uint32_t from, std::uint32_t to) {
    return std::any_of(states.begin() + from + 1, states.begin() + to,
                       [](const PointState& each) { return each.bad; });
  };
  Built list, single;
  std::uint32_t before = chosen.front(), end = 0;
  for (const std::uint32_t at : chosen) {
    const PointState& point = states[at];
    end = std::max(end, point.end);
    if (!list.ranges.empty() && !(at > before && refused_between(before, at)) &&
        device.cost().joins(list.ranges.back(), point.area, point.first, point.end)) {
      Range& last = list.ranges.back();
      last.count = std::max(last.end(), point.end) - last.first;
    } else {
      list.ranges.push_back({point.area, point.first, point.end - point.first});
    }
    before = at;
  }
  const bool only_point = chosen.size() == 1;
  const PointState& front = states[chosen.front()];
  single.ranges = {{front.area, front.first, end - front.first}};
  const bool one_area = front.area == states[chosen.back()].area;
  const auto listed = device.cost().of(ReadRequest{list.ranges}, only_point);
  const auto covered = one_area && !refused_between(chosen.front(), chosen.back())
                           ? device.cost().of(ReadRequest{single.ranges}, only_point)
                           : std::nullopt;
  if (!listed && !covered) return std::nullopt;
  Built& best = covered && (!listed || *covered < *listed) ? single : list;
  best.cost = &best == &single ? *covered : *listed;
  return best;
}

// Takes the n most urgent candidates. Returns every n that fits while n + 1 does not: more points
// may need fewer ranges.
template <typename Candidate>
std::vector<std::vector<bool>> ways_to_take(const ListedDevice& device, std::vector<bool> taken,
                                            const Candidate& candidate, Duration budget) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t at = 0; at < device.states.size(); ++at) {
    if (!taken[at] && candidate(at)) order.push_back(at);
  }
  std::ranges::sort(order, {}, [&](std::uint32_t at) { return device.states[at].due; });
  std::vector<std::vector<bool>> ways;
  bool fits = true;
  for (const std::uint32_t at : order) {
    std::vector<bool> more = taken;
    more[at] = true;
    const auto built = built_of(device, more);
    const bool now = built && built->cost <= budget;
    if (fits && !now) ways.push_back(taken);
    taken = std::move(more);
    fits = now;
  }
  if (fits) ways.push_back(taken);
  return ways;
}

std::vector<std::uint32_t> members_of(const ListedDevice& device, const Built& built,
                                      const std::vector<bool>& taken, std::uint32_t begin,
                                      std::uint32_t end) {
  std::vector<std::uint32_t> members;
  for (std::uint32_t at = begin; at < end; ++at) {
    const PointState& point = device.states[at];
    const bool covered = std::ranges::any_of(built.ranges, [&](const Range& range) {
      return range.area == point.area && range.first <= point.first && point.end <= range.end();
    });
    if (covered && (!point.bad || taken[at])) members.push_back(at);
  }
  return members;
}

TEST(ListShape, ReadsAreAsTheRulesSayWhateverTheStateOfTheirPoints) {
  int limited = 0, with_budget = 0, whole = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto below = [&](unsigned count) { return static_cast<unsigned>(random() % count); };
    std::vector<std::pair<std::string, std::uint32_t>> points;
    const unsigned family = seed % 3;
    const char* const areas[3][2] = {{"VW", "MW"}, {"DM", "W"}, {"int16:", "int32:"}};
    for (unsigned i = 0, at = 0; i < 34; ++i, at += 1 + below(below(3) == 0 ? 50 : 4)) {
      const bool second = i > 24;
      points.emplace_back(areas[family][second] + std::to_string(second ? 2 * (i - 25) : at),
                          family == 0 ? 2 : 1 + below(2));
    }
    const auto max_block = static_cast<std::uint16_t>(below(3) == 0 ? 6 + below(20) : 0);
    ListedDevice device(family == 0   ? "s7-ppi"
                        : family == 1 ? "omron-hostlink"
                                      : "dtc",
                        family == 1 ? std::map<std::string, std::string>{{"mode", "fins"}}
                                    : std::map<std::string, std::string>{},
                        points, max_block);
    if (device.states.size() < 4) continue;
    std::vector<std::uint32_t> ready;
    const bool all_intensive = below(6) == 0;
    for (std::uint32_t at = 0; at < device.states.size(); ++at) {
      PointState& state = device.states[at];
      state.mode = all_intensive || below(4) == 0 ? Mode::kIntensive : Mode::kScheduled;
      if (below(12) == 0) state.mode = Mode::kOnDemand;
      state.due = state.deadline = kNow - 300ms + Duration{1'000'000 * below(2500) + at};
      state.bad = below(14) == 0;
      state.eager = below(5) == 0;
      if (below(10) == 0) state.cut_until = kNow + (below(2) == 0 ? 1s : -1s);
      if (below(10) == 0) state.retry_at = kNow + 1s;
      if (state.ready(kNow)) ready.push_back(at);
    }
    if (ready.empty()) continue;
    const std::uint32_t urgent = ready[below(static_cast<unsigned>(ready.size()))];
    const Allowance allowance{
        below(2) == 0 ? Duration::zero() : Duration{std::chrono::milliseconds{60 + below(150)}},
        below(2) == 0 ? Duration::zero() : Duration{700ms}};
    ReadSelector selector(ShapeRule::kCyclic);
    const Selection& read = device.select(selector, urgent, allowance);

    std::uint32_t begin = urgent, end = urgent + 1;
    if (!device.states[urgent].bad) {
      while (begin > 0 && device.states[begin].cut_until <= kNow) --begin;
      while (end < device.states.size() && device.states[end].cut_until <= kNow) ++end;
    }
    const auto candidate = [&](std::uint32_t at) {
      return begin <= at && at < end && !device.states[at].bad && device.states[at].ready(kNow);
    };
    std::vector<bool> alone(device.states.size());
    alone[urgent] = true;
    const bool alike = device.states[urgent].mode == Mode::kIntensive &&
                       std::ranges::all_of(device.states, [](const PointState& each) {
                         return each.mode == Mode::kIntensive;
                       });
    const JoinRule rule = join_rule(device.states, urgent, kNow, allowance, {});
    const auto due = [&](std::uint32_t at) {
      return candidate(at) && (alike || rule.joins(device.states[at]));
    };
    std::vector<std::vector<bool>> ways = ways_to_take(device, alone, due, Duration::max());
    if (!alike && allowance.budget > Duration::zero()) {
      std::vector<std::vector<bool>> more;
      for (const auto& way : ways) {
        const auto worth = [&](std::uint32_t at) {
          return candidate(at) && (rule.joins(device.states[at]) || device.states[at].eager);
        };
        std::ranges::copy(ways_to_take(device, way, worth, allowance.budget),
                          std::back_inserter(more));
      }
      with_budget += more != ways;
      ways = more;
    }
    whole += alike;
    limited += ways.size() > 1 || ways.front() != alone;
    const bool as_ruled = std::ranges::any_of(ways, [&](const std::vector<bool>& taken) {
      const auto built = built_of(device, taken);
      return built && built->ranges == read.ranges() && built->cost == read.cost &&
             members_of(device, *built, taken, begin, end) == read.members;
    });
    EXPECT_TRUE(as_ruled);
  }
  EXPECT_GT(limited, 100);
  EXPECT_GT(with_budget, 10);
  EXPECT_GT(whole, 5);
}

}  // namespace
}  // namespace fieldcast

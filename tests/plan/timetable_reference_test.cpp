// Timetables of random requests, compared with what follows from their phases by the definitions
// in timetable.hpp, and with the best of all phases and orders.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include "core/plan/timetable.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Duration kReferencePeriod = 100ms;
constexpr TableTiming kReferenceTiming{kReferencePeriod, 106ms, 0.02};

bool due(const TimetableMember& member, Slots slot) {
  return slot % member.period == member.phase % member.period;
}

// Wire time of one transmission of the members that are due in the slot.
Duration cost_in(const TimetableRequest& request, Slots slot) {
  struct Run {
    std::uint32_t area, first, end;
    const TimetableMember* begin;
  };
  std::vector<Run> runs;
  for (const TimetableMember& member : request.members) {
    if (!due(member, slot)) continue;
    const bool joins =
        !runs.empty() && (!request.list || (runs.back().area == member.area &&
                                            member.first <= runs.back().end + member.bridge));
    if (joins)
      runs.back().end = std::max(runs.back().end, member.end);
    else
      runs.push_back({member.area, member.first, member.end, &member});
  }
  if (runs.empty()) return Duration::zero();
  Duration sum = request.base_cost;
  for (const Run& run : runs) {
    const auto item = static_cast<Duration::rep>(run.begin->item_ns);
    sum += request.list ? run.begin->range_cost + Duration{item * (run.end - run.first - 1)}
                        : Duration{item * (run.end - run.first)};
  }
  return sum;
}

Duration part_of_gap(const TimetableMember& member, double reserve) {
  return Duration{static_cast<Duration::rep>(
      member.fits * static_cast<double>(kReferenceTiming.gap.count()) * (1 - reserve))};
}

// What the phases, periods and ranks of a timetable imply.
struct Reference {
  // `frequent`: period of the most frequent requests when the table was filled; 0: as now.
  Reference(const Timetable& filled, std::size_t count, Slots frequent = 0) : table(filled) {
    for (std::size_t index = 0; index < count; ++index) requests.push_back(filled.request(index));
    slots = static_cast<Slots>(filled.hyperperiod() / filled.slot());
    shortest = slots;
    for (const TimetableRequest& each : requests) {
      if (!each.members.empty()) shortest = std::min(shortest, each.period);
      costs.emplace_back();
      for (Slots slot = 0; slot < slots; ++slot) costs.back().push_back(cost_in(each, slot));
    }
    if (frequent != 0) shortest = frequent;
    order.resize(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t index) {
      const bool most_frequent =
          !requests[index].members.empty() && requests[index].period == shortest;
      return std::tuple(requests[index].rank, most_frequent, requests[index].period);
    });
  }
  [[nodiscard]] Duration gap(std::size_t index, const TimetableMember& member, Slots slot,
                             const std::vector<std::vector<Duration>>& ends,
                             Duration table_length) const {
    const Slots next = slot + member.period;
    return ends[index][next % slots] + next / slots * table_length - ends[index][slot];
  }
  template <typename Visit>
  void for_each_read(const Visit& visit) const {
    for (std::size_t index = 0; index < requests.size(); ++index) {
      for (const TimetableMember& member : requests[index].members) {
        for (Slots slot = member.phase; slot < slots; slot += member.period)
          visit(index, member, slot);
      }
    }
  }
  // As if the wire never rested.
  [[nodiscard]] double spare() const {
    std::vector<std::vector<Duration>> ends(requests.size(), std::vector<Duration>(slots));
    Duration now{};
    for (Slots slot = 0; slot < slots; ++slot) {
      for (const std::size_t index : order) ends[index][slot] = now += costs[index][slot];
    }
    double least = 1;
    for_each_read([&](std::size_t index, const TimetableMember& member, Slots slot) {
      const auto longest = static_cast<double>(gap(index, member, slot, ends, now).count());
      least = std::min(least, 1 - longest / static_cast<double>(part_of_gap(member, 0).count()));
    });
    return least;
  }

  void expect_costs() const {
    Duration sum{};
    for (std::size_t index = 0; index < requests.size(); ++index) {
      const Duration own = std::accumulate(costs[index].begin(), costs[index].end(), Duration{});
      const auto share =
          static_cast<double>(own.count()) / static_cast<double>(table.hyperperiod().count());
      EXPECT_NEAR(table.load(index), share, 1e-9) << "request " << index;
      sum += own;
    }
    EXPECT_NEAR(table.load(),
                static_cast<double>(sum.count()) / static_cast<double>(table.hyperperiod().count()),
                1e-9);
  }

  // No two reads overlap, and each ends as early as it may: after the reads before it and the start
  // of its slot, or when the next read of one of its points would be too late otherwise.
  void expect_ends(double base_share) const {
    std::vector<std::vector<Duration>> ends;
    for (std::size_t index = 0; index < requests.size(); ++index)
      ends.emplace_back(table.ends(index).begin(), table.ends(index).end());
    EXPECT_NEAR(table.spare(), spare(), 1e-9);
    const double reserve =
        std::min({kReferenceTiming.reserve, table.spare(), (1 - base_share) / 2});
    Duration before = Duration::min() / 2;
    for (const std::size_t index : order) {
      for (Slots slot = 0; slot < slots; ++slot) {
        if (costs[index][slot] != Duration::zero())
          before = std::max(before, ends[index][slot] - table.hyperperiod());
      }
    }
    for (Slots slot = 0; slot < slots; ++slot) {
      for (const std::size_t index : order) {
        const Duration cost = costs[index][slot], end = ends[index][slot];
        if (cost == Duration::zero()) {
          EXPECT_EQ(end, Duration::zero());
          continue;
        }
        const Duration soonest = std::max(before, slot * table.slot()) + cost;
        EXPECT_GE(end, soonest) << "request " << index << ", slot " << slot;
        bool waits = false;
        for (const TimetableMember& member : requests[index].members) {
          if (!due(member, slot)) continue;
          const Duration left =
              part_of_gap(member, reserve) - gap(index, member, slot, ends, table.hyperperiod());
          EXPECT_GE(left, -1us) << "request " << index << ", slot " << slot;
          waits = waits || left < 1us;
        }
        EXPECT_TRUE(end == soonest || waits) << "request " << index << ", slot " << slot;
        before = end;
      }
    }
    for (std::size_t index = 0; index < requests.size(); ++index) {
      Duration latest{};
      for (Slots slot = 0; slot < slots; ++slot) {
        if (costs[index][slot] != Duration::zero())
          latest = std::max(latest, ends[index][slot] - slot * table.slot());
      }
      EXPECT_EQ(requests[index].latest_end, latest) << "request " << index;
      Duration slack = 5ms;
      for (const TimetableMember& member : requests[index].members) {
        Duration longest{};
        for (Slots slot = member.phase; slot < slots; slot += member.period)
          longest = std::max(longest, gap(index, member, slot, ends, table.hyperperiod()));
        EXPECT_EQ(table.longest_gap(index, member), longest);
        slack = std::min(slack, part_of_gap(member, kReferenceTiming.reserve) - longest);
      }
      EXPECT_EQ(table.slack(index, 5ms), std::max(slack, Duration::zero())) << "request " << index;
    }
  }

  const Timetable& table;
  std::vector<TimetableRequest> requests;
  Slots slots = 1, shortest = 1;
  std::vector<std::vector<Duration>> costs;  // by request and slot
  std::vector<std::size_t> order;            // in a slot
};

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }

  // One range of at most `members` points, or a list of ranges in two areas.
  TimetableRequest request(unsigned members) {
    constexpr double kFits[] = {1, 1, 1.5, 2, 2.5, 3, 4, 5, 8, 10, 20, 60, 1000};
    TimetableRequest made;
    made.list = below(2) == 0;
    made.base_cost = std::chrono::microseconds{1000 + below(3000)};
    const bool wide = below(3) == 0;
    std::uint32_t at = below(20);
    const unsigned count = 1 + below(members);
    for (unsigned i = 0; i < count; ++i) {
      TimetableMember& member = made.members.emplace_back();
      member.area = made.list && i >= count / 2 ? 1 : 0;
      member.first = at;
      member.end = at + 1 + below(wide ? 8 : 2);
      at = (wide ? at : member.end) + below(4);
      if (made.list && i + 1 == count / 2) at = below(4);
      member.item_ns = 20'000 + 10'000 * member.area;
      member.range_cost = made.list ? Duration{90'000 + 40'000 * member.area} : Duration{20'000};
      member.bridge = made.list ? 2 + member.area : 0;
      member.fits = kFits[below(13)];
    }
    return made;
  }
  std::vector<TimetableRequest> requests(unsigned members) {
    std::vector<TimetableRequest> made;
    const unsigned count = 1 + below(8);
    for (unsigned i = 0; i < count; ++i) made.push_back(request(members));
    return made;
  }

 private:
  std::mt19937 random_;
};

void expect_all(const Timetable& table, std::size_t count, Duration base_period = kReferencePeriod,
                Slots frequent = 0) {
  const Reference reference(table, count, frequent);
  reference.expect_costs();
  reference.expect_ends(static_cast<double>(base_period.count()) /
                        static_cast<double>(kReferenceTiming.gap.count()));
}

TEST(TimetableReference, CostsAndEndsFollowFromThePhases) {
  int tables = 0, beyond_a_word = 0;  // of those: with more than 64 members in a request
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const auto requests = draw.requests(seed % 10 == 0 ? 150 : 6);
    Timetable table(kReferenceTiming);
    const std::vector<Timetable> others = table.fill(requests, seed % 3);
    if (table.load() > 0.95) continue;
    ++tables;
    beyond_a_word += std::ranges::any_of(
        requests, [](const TimetableRequest& each) { return each.members.size() > 64; });
    expect_all(table, requests.size());
    for (const Timetable& other : others) expect_all(other, requests.size());
    table.set_period(kReferencePeriod - 3ms);
    expect_all(table, requests.size(), kReferencePeriod - 3ms);
  }
  EXPECT_GE(tables, 20);
  EXPECT_GE(beyond_a_word, 2);
}

TEST(TimetableReference, AChangedRequestLeavesThePhasesOfOthers) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(100 + seed);
    const auto requests = draw.requests(6);
    Timetable table(kReferenceTiming);
    table.fill(requests, 1);
    const Slots frequent = Reference(table, requests.size()).shortest;
    for (unsigned change = 0; change < 4; ++change) {
      const std::size_t changed = draw.below(static_cast<unsigned>(requests.size()));
      const Reference before(table, requests.size());
      TimetableRequest next = before.requests[changed];
      const bool cost_alone = draw.below(2) == 0 && !next.members.empty();
      if (cost_alone)
        next.base_cost += 300us;
      else
        next = draw.below(4) == 0 ? TimetableRequest{} : draw.request(6);
      table.change(changed, next);
      table.align();
      if (table.load() > 0.95) break;
      expect_all(table, requests.size(), kReferencePeriod, frequent);
      for (std::size_t index = 0; index < requests.size(); ++index) {
        if (index == changed && !cost_alone) continue;
        EXPECT_EQ(table.request(index).phase, before.requests[index].phase);
        for (std::size_t which = 0; which < before.requests[index].members.size(); ++which)
          EXPECT_EQ(table.request(index).members[which].phase,
                    before.requests[index].members[which].phase);
      }
    }
  }
}

// The best spare of all phases and orders, for a small table.
class BestOfAll {
 public:
  BestOfAll(const Timetable& table, std::size_t count) : now_(table, count) {
    for (std::size_t index = 0; index < count; ++index) {
      if (now_.requests[index].period == 1) frequent_.push_back(index);
    }
  }
  double spare() {
    std::vector<std::size_t> ranks(frequent_.size());
    std::iota(ranks.begin(), ranks.end(), std::size_t{0});
    do {
      for (std::size_t i = 0; i < ranks.size(); ++i)
        now_.requests[frequent_[i]].rank = static_cast<std::uint32_t>(ranks[i]);
      try_request(0);
    } while (std::ranges::next_permutation(ranks).found);
    return best_;
  }

 private:
  void try_request(std::size_t index) {
    if (index == now_.requests.size()) {
      std::iota(now_.order.begin(), now_.order.end(), std::size_t{0});
      std::ranges::stable_sort(now_.order, {}, [&](std::size_t each) {
        const TimetableRequest& request = now_.requests[each];
        return std::tuple(request.rank, request.period == 1, request.period);
      });
      best_ = std::max(best_, now_.spare());
      return;
    }
    TimetableRequest& request = now_.requests[index];
    if (request.period == 1) {
      try_member(index, 0);
      return;
    }
    for (request.rank = 0; request.rank <= frequent_.size(); ++request.rank) {
      for (request.phase = 0; request.phase < request.period; ++request.phase) try_member(index, 0);
    }
  }
  void try_member(std::size_t index, std::size_t which) {
    TimetableRequest& request = now_.requests[index];
    if (which == request.members.size()) {
      for (Slots slot = 0; slot < now_.slots; ++slot)
        now_.costs[index][slot] = cost_in(request, slot);
      try_request(index + 1);
      return;
    }
    TimetableMember& member = request.members[which];
    for (member.phase = request.phase; member.phase < member.period; member.phase += request.period)
      try_member(index, which + 1);
  }

  Reference now_;
  std::vector<std::size_t> frequent_;
  double best_ = -1;
};

TEST(TimetableReference, TheSearchFindsTheBestOrderAndPhasesOfASmallTable) {
  int crowded = 0, best = 0, better = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Draw draw(200 + seed);
    std::vector<TimetableRequest> requests;
    for (unsigned i = 0; i < 5; ++i) {
      TimetableRequest& made = requests.emplace_back();
      made.base_cost = std::chrono::milliseconds{12 + draw.below(10)};
      const bool fast = i < 2 || draw.below(3) == 0;
      for (const double fits : {fast ? 1.0 : 2.0 + 2 * draw.below(2), 2.0 + 2 * draw.below(2)}) {
        TimetableMember& member = made.members.emplace_back();
        member.fits = fits;
        member.first = made.members.size() == 1 ? 0 : 10 + draw.below(10);
        member.end = member.first + 1;
        member.item_ns = 800'000;
        if (draw.below(2) == 0) break;
      }
    }
    Timetable plain(kReferenceTiming), table(kReferenceTiming);
    plain.fill(requests, 2, false);
    if (plain.load() > 1 || plain.spare() >= kReferenceTiming.reserve) continue;
    table.fill(requests, 2);
    const double possible =
        std::min(kReferenceTiming.reserve, BestOfAll(table, requests.size()).spare());
    ++crowded;
    best += std::min(kReferenceTiming.reserve, table.spare()) > possible - 1e-9;
    better += table.spare() > plain.spare();
  }
  EXPECT_GE(crowded, 5);
  EXPECT_EQ(best, crowded);
  EXPECT_EQ(better, crowded);
}

}  // namespace
}  // namespace fieldcast

#include "core/plan/timetable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Duration kBasePeriod = 100ms;
constexpr TableTiming kTiming{kBasePeriod, 106ms, 0.02};

// One point for each number of base periods that fits in its allowed gap, ten items apart.
TimetableRequest request(std::vector<double> fits) {
  TimetableRequest made;
  made.base_cost = 10ms;
  for (const double each : fits) {
    TimetableMember member;
    member.first = static_cast<std::uint32_t>(10 * made.members.size());
    member.end = member.first + 1;
    member.item_ns = 1'000'000;
    member.range_cost = 1ms;
    member.fits = each;
    made.members.push_back(member);
  }
  return made;
}

TEST(Timetable, PeriodsAreWholeSlotsAndNeverLongerThanAllowed) {
  Timetable table(kTiming);
  table.fill({request({1, 2, 5, 10, 100}), request({2.5, 7}), request({1000})}, 2);
  for (std::size_t index = 0; index < 3; ++index) {
    for (const TimetableMember& member : table.request(index).members) {
      EXPECT_GE(member.period, 1u);
      EXPECT_LE(member.period * table.slot(), member.fits * kBasePeriod + 1ms);
      EXPECT_LT(member.phase, member.period);
      EXPECT_EQ(member.phase % table.request(index).period, table.request(index).phase);
    }
  }
}

TEST(Timetable, SlowPointsOfManyRequestsAreSpreadOverTheSlots) {
  Timetable table(kTiming);
  std::vector<TimetableRequest> requests;
  for (int i = 0; i < 20; ++i) requests.push_back(request({10}));
  table.fill(requests, 2);
  std::vector<int> in_slot(10);
  for (std::size_t index = 0; index < requests.size(); ++index)
    ++in_slot[table.request(index).phase % 10];
  EXPECT_EQ(*std::min_element(in_slot.begin(), in_slot.end()), 2);
  EXPECT_EQ(*std::max_element(in_slot.begin(), in_slot.end()), 2);
  EXPECT_NEAR(table.load(), 2 * 11.0 / 100, 0.001);  // two requests of 11 ms in each slot of 100 ms
}

TEST(Timetable, NeighboursOfOneRefreshShareASlot) {
  Timetable table(kTiming);
  TimetableRequest far = request({1, 10, 10});
  far.members[1].first = 40, far.members[1].end = 41;
  far.members[2].first = 41, far.members[2].end = 42;
  table.fill({far}, 2);
  EXPECT_EQ(table.request(0).members[1].phase, table.request(0).members[2].phase);
}

TEST(Timetable, AReadEndsAtTheLatestWhenThoseBeforeItDo) {
  Timetable table(kTiming);
  table.fill({request({1}), request({1})}, 2);
  EXPECT_EQ(table.request(0).latest_end, 11ms);
  EXPECT_EQ(table.request(1).latest_end, 22ms);
}

TEST(Timetable, OtherCostsLeaveThePhasesAndOtherMembersLeaveThoseOfTheRest) {
  Timetable table(kTiming);
  const std::vector<TimetableRequest> requests{request({1, 10, 20}), request({1, 10}),
                                               request({5, 50})};
  table.fill(requests, 2);
  const TimetableRequest first = table.request(0), last = table.request(2);
  TimetableRequest slower = requests[0];
  slower.base_cost = 15ms;
  table.change(0, slower);
  table.align();
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(table.request(0).members[i].phase, first.members[i].phase) << i;
  EXPECT_GT(table.request(0).latest_end, first.latest_end);
  table.change(1, request({2, 4}));
  table.align();
  EXPECT_EQ(table.request(1).period * table.slot(), 2 * kBasePeriod);
  EXPECT_EQ(table.request(2).phase, last.phase);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(table.request(2).members[i].phase, last.members[i].phase) << i;
}

TEST(Timetable, ARequestWithoutMembersTakesNoTime) {
  Timetable table(kTiming);
  table.fill({request({1}), TimetableRequest{}}, 2);
  EXPECT_NEAR(table.load(), 0.11, 0.001);
  table.change(0, TimetableRequest{});
  table.align();
  EXPECT_EQ(table.load(), 0.0);
}

// A busy bus: fast, slow and mixed requests, drawn by `seed`.
std::vector<TimetableRequest> busy(unsigned seed) {
  constexpr double kFits[] = {1, 2, 5, 10, 20};
  std::mt19937 random(seed);
  std::vector<TimetableRequest> requests;
  for (unsigned i = 0; i < 8; ++i) {
    std::vector<double> fits;
    for (unsigned member = 0; member < 3; ++member) fits.push_back(kFits[random() % 5]);
    if (i < 3) fits[0] = 1;
    requests.push_back(request(fits));
    requests.back().base_cost = 4ms;
    for (TimetableMember& member : requests.back().members) {
      member.first /= 4;
      member.end = member.first + 1;
    }
  }
  return requests;
}

// A search without an end would hang here: no move can make these rounds shorter.
TEST(Timetable, ACrowdedTableWithLittleToMoveIsFilled) {
  for (const std::vector<double>& fits : {std::vector<double>{1}, std::vector<double>{1, 2}}) {
    Timetable table(kTiming);
    TimetableRequest only = request(fits);
    only.base_cost = 105ms;
    table.fill({only}, 2);
    EXPECT_LT(table.spare(), kTiming.reserve);
    EXPECT_EQ(table.request(0).period, 1u);
  }
}

TEST(Timetable, AReadThatEndsEarlyByTheSlackMakesNoGapTooLong) {
  bool early = false;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Timetable table(kTiming);
    const auto requests = busy(seed);
    table.fill(requests, 2);
    for (std::size_t index = 0; index < requests.size(); ++index) {
      const Duration slack = table.slack(index, 5ms);
      EXPECT_LE(slack, 5ms) << seed;
      early = early || slack > Duration::zero();
      for (const TimetableMember& member : table.request(index).members)
        EXPECT_LE(table.longest_gap(index, member) + slack, member.fits * kTiming.gap) << seed;
    }
  }
  EXPECT_TRUE(early);
}

TEST(Timetable, ReadsFollowEachOtherAndNoGapIsLongerThanAllowed) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Timetable table(kTiming);
    const auto requests = busy(seed);
    table.fill(requests, 2);
    ASSERT_LT(table.load(), 1) << seed;
    const auto slots = static_cast<Slots>(table.hyperperiod() / table.slot());
    std::vector<Duration> ends;
    for (std::size_t index = 0; index < requests.size(); ++index) {
      const TimetableRequest& planned = table.request(index);
      for (Slots slot = planned.phase; slot < slots; slot += planned.period) {
        if (table.ends(index)[slot] == Duration::zero()) continue;
        EXPECT_GE(table.ends(index)[slot], table.slot() * slot + planned.base_cost) << seed;
        ends.push_back(table.ends(index)[slot]);
      }
      for (const TimetableMember& member : planned.members)
        EXPECT_LE(table.longest_gap(index, member), member.fits * kTiming.gap) << seed;
    }
    std::ranges::sort(ends);
    for (std::size_t i = 1; i < ends.size(); ++i)
      EXPECT_GE(ends[i] - ends[i - 1], 5ms) << "a read of one item lasts 5 ms, seed " << seed;
    EXPECT_LE(ends.back() - ends.front(), table.hyperperiod() - 5ms) << seed;
  }
}

TEST(Timetable, LastEndIsTheLastOneUpToATime) {
  Timetable table(kTiming);
  table.fill(busy(3), 2);
  const auto slots = static_cast<Slots>(table.hyperperiod() / table.slot());
  for (std::size_t index = 0; index < 8; ++index) {
    for (const TimetableMember& member : table.request(index).members) {
      for (Duration until = -300ms; until < 3 * table.hyperperiod(); until += 7'123us) {
        Duration last = Duration::min();
        for (int table_number = -2; table_number <= 3; ++table_number) {
          for (Slots slot = member.phase; slot < slots; slot += member.period) {
            const Duration end = table.ends(index)[slot] + table_number * table.hyperperiod();
            if (end <= until) last = std::max(last, end);
          }
        }
        ASSERT_EQ(table.last_end(index, member.phase, member.period, until), last);
      }
    }
  }
}

// Two fast requests have a slow point that needs 30 ms in every second slot. If both are read in
// the same slot, the gap of the second one is 60 ms longer than its slot.
TEST(Timetable, TheSearchMakesRoundsEqual) {
  TimetableRequest wide = request({1, 2});
  wide.members[1].first = 30, wide.members[1].end = 31;
  std::vector<TimetableRequest> requests{wide, wide, request({2}), request({2}), request({2})};
  requests[2].base_cost = requests[3].base_cost = 29ms;
  Timetable plain(kTiming), searched(kTiming);
  plain.fill(requests, 0);
  searched.fill(requests, 6);
  const auto longest = [&](const Timetable& table) {
    Duration gap{};
    for (std::size_t index = 0; index < 2; ++index)
      gap = std::max(gap, table.longest_gap(index, table.request(index).members[0]));
    return gap;
  };
  EXPECT_LE(longest(searched), kTiming.gap);
  EXPECT_LE(longest(searched), longest(plain));
}

}  // namespace
}  // namespace fieldcast

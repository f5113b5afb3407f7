#include "core/plan/timetable.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Duration kBasePeriod = 100ms;
constexpr Duration kSlack = 4ms;

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
  Timetable table(kBasePeriod, kSlack);
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
  Timetable table(kBasePeriod, kSlack);
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
  Timetable table(kBasePeriod, kSlack);
  TimetableRequest far = request({1, 10, 10});
  far.members[1].first = 40, far.members[1].end = 41;
  far.members[2].first = 41, far.members[2].end = 42;
  table.fill({far}, 2);
  EXPECT_EQ(table.request(0).members[1].phase, table.request(0).members[2].phase);
}

TEST(Timetable, AReadEndsAtTheLatestWhenThoseBeforeItDo) {
  Timetable table(kBasePeriod, kSlack);
  table.fill({request({1}), request({1})}, 2);
  EXPECT_EQ(table.request(0).latest_end, 11ms);
  EXPECT_EQ(table.request(1).latest_end, 22ms);
}

TEST(Timetable, OtherCostsLeaveThePhasesAndOtherMembersLeaveThoseOfTheRest) {
  Timetable table(kBasePeriod, kSlack);
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
  Timetable table(kBasePeriod, kSlack);
  table.fill({request({1}), TimetableRequest{}}, 2);
  EXPECT_NEAR(table.load(), 0.11, 0.001);
  table.change(0, TimetableRequest{});
  table.align();
  EXPECT_EQ(table.load(), 0.0);
}

}  // namespace
}  // namespace fieldcast

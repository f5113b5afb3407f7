// Laps, turns and instants of a timetable.
#include "core/schedule/timetable.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fieldcast {
namespace {

constexpr std::int64_t kBeat = 100'000'000;  // ns
constexpr std::int64_t kRoom = 4'000'000;

// One point for each number of beats that its period holds, ten items apart.
TimetableRequest request(std::vector<double> fits) {
  TimetableRequest made;
  made.base = 10'000'000;
  for (const double each : fits) {
    TimetableMember member;
    member.first = static_cast<std::uint32_t>(10 * made.members.size());
    member.end = member.first + 1;
    member.item_ns = 1'000'000;
    member.range_ns = 1'000'000;
    member.fits = each;
    made.members.push_back(member);
  }
  return made;
}

TEST(Timetable, LapsAreWholeFramesAndNeverLongerThanAPeriod) {
  Timetable table(kBeat, kRoom);
  table.fill({request({1, 2, 5, 10, 100}), request({2.5, 7}), request({1000})}, 2);
  for (std::size_t index = 0; index < 3; ++index) {
    for (const TimetableMember& member : table.request(index).members) {
      EXPECT_GE(member.lap, 1u);
      EXPECT_LE(static_cast<double>(member.lap * table.frame()), member.fits * kBeat + 1e6);
      EXPECT_LT(member.turn, member.lap);
      EXPECT_EQ(member.turn % table.request(index).beat, table.request(index).phase);
    }
  }
}

TEST(Timetable, SlowPointsOfManyRequestsAreSpreadOverTheFrames) {
  Timetable table(kBeat, kRoom);
  std::vector<TimetableRequest> requests;
  for (int i = 0; i < 20; ++i) requests.push_back(request({10}));
  table.fill(requests, 2);
  std::vector<int> in_frame(10);
  for (std::size_t index = 0; index < requests.size(); ++index)
    ++in_frame[table.request(index).phase % 10];
  EXPECT_EQ(*std::min_element(in_frame.begin(), in_frame.end()), 2);
  EXPECT_EQ(*std::max_element(in_frame.begin(), in_frame.end()), 2);
  EXPECT_NEAR(table.load(), 2 * 11.0 / 100, 0.001);  // two requests of 11 ms in each frame of 100
}

TEST(Timetable, NeighboursOfOneRefreshShareTheWay) {
  Timetable table(kBeat, kRoom);
  TimetableRequest far = request({1, 10, 10});
  far.members[1].first = 40, far.members[1].end = 41;
  far.members[2].first = 41, far.members[2].end = 42;
  table.fill({far}, 2);
  EXPECT_EQ(table.request(0).members[1].turn, table.request(0).members[2].turn);
}

TEST(Timetable, AReadEndsAtTheLatestWhenThoseBeforeItDo) {
  Timetable table(kBeat, kRoom);
  table.fill({request({1}), request({1})}, 2);
  EXPECT_EQ(table.request(0).latest, 11'000'000);
  EXPECT_EQ(table.request(1).latest, 22'000'000);
}

TEST(Timetable, OtherCostsLeaveTheTurnsAndOtherMembersLeaveThoseOfTheRest) {
  Timetable table(kBeat, kRoom);
  const std::vector<TimetableRequest> requests{request({1, 10, 20}), request({1, 10}),
                                               request({5, 50})};
  table.fill(requests, 2);
  const TimetableRequest first = table.request(0), last = table.request(2);
  TimetableRequest slower = requests[0];
  slower.base = 15'000'000;
  table.change(0, slower);
  table.align();
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(table.request(0).members[i].turn, first.members[i].turn) << i;
  EXPECT_GT(table.request(0).latest, first.latest);
  table.change(1, request({2, 4}));
  table.align();
  EXPECT_EQ(table.request(1).beat * table.frame(), 2 * kBeat);
  EXPECT_EQ(table.request(2).phase, last.phase);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(table.request(2).members[i].turn, last.members[i].turn) << i;
}

TEST(Timetable, ARequestWithoutMembersTakesNoTime) {
  Timetable table(kBeat, kRoom);
  table.fill({request({1}), TimetableRequest{}}, 2);
  EXPECT_NEAR(table.load(), 0.11, 0.001);
  table.change(0, TimetableRequest{});
  table.align();
  EXPECT_EQ(table.load(), 0.0);
}

}  // namespace
}  // namespace fieldcast

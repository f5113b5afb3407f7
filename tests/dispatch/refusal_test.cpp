#include <gtest/gtest.h>

#include <set>

#include "core/dispatch/plan_runner.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// One device with registers 0, 2, 4 .. 38; refuses every read that touches `holes`.
class RefusingDevice : public ::testing::Test {
 protected:
  RefusingDevice() {
    Map map;
    for (std::uint32_t i = 0; i < 20; ++i) map.push_back({1, 2 * i, 1.0});
    input_ = input_of(map, kFakeProtocol);
    scheduler_ = make_scheduler(input_);
    wire_ = std::make_unique<VirtualWire>(input_, *scheduler_);
    wire_->device = [this](const Block& block) {
      for (const std::uint32_t hole : holes_) {
        if (block.ranges[0].first <= hole && hole < block.ranges[0].end())
          return ++refused_, Answer::kRefused;
      }
      return Answer::kGood;
    };
  }
  std::set<std::uint32_t> holes_;
  unsigned refused_ = 0;
  ScheduleInput input_;
  std::unique_ptr<Scheduler> scheduler_;
  std::unique_ptr<VirtualWire> wire_;
};

TEST_F(RefusingDevice, GapBetweenTwoGoodHalvesBecomesABarrier) {
  holes_ = {15};
  wire_->run(3s);
  EXPECT_TRUE(wire_->bad.empty());
  refused_ = 0;
  wire_->forget_gaps();
  wire_->run(60s);
  EXPECT_EQ(refused_, 0u);
  EXPECT_EQ(wire_->missed(), 0u);
  EXPECT_LE(wire_->blocks(), 2 * 72u);  // the two sides of the barrier, each in one block
}

TEST_F(RefusingDevice, SinglePointIsFoundBadAndTheOthersKeepTheirRefresh) {
  holes_ = {14};
  wire_->run(3s);
  EXPECT_EQ(wire_->bad, std::vector<PointIndex>{7});
  EXPECT_LE(refused_, 6u);  // binary search
  refused_ = 0;
  wire_->forget_gaps();
  wire_->run(60s);
  EXPECT_EQ(refused_, 0u);
  EXPECT_EQ(wire_->missed(), 0u);
  EXPECT_EQ(wire_->seen(7).count, 0u);
}

TEST_F(RefusingDevice, SeveralHolesAreAllFound) {
  holes_ = {0, 13, 14, 26, 38};
  wire_->run(10s);
  EXPECT_EQ(std::set<PointIndex>(wire_->bad.begin(), wire_->bad.end()),
            (std::set<PointIndex>{0, 7, 13, 19}));
  refused_ = 0;
  wire_->forget_gaps();
  wire_->run(60s);
  EXPECT_EQ(refused_, 0u);
  for (PointIndex point = 0; point < 20; ++point) {
    EXPECT_EQ(wire_->seen(point).missed, 0u) << point;
    if (holes_.count(2 * point) == 0) { EXPECT_GE(wire_->seen(point).count, 60u) << point; }
  }
}

TEST_F(RefusingDevice, BadPointIsTriedAgainAloneAndComesBack) {
  holes_ = {14};
  wire_->forget = 30s;
  wire_->run(25s);
  EXPECT_EQ(wire_->bad.size(), 1u);
  wire_->check = [](const Block& block) {
    if (std::count(block.points.begin(), block.points.end(), 7u)) {
      EXPECT_EQ(block.points.size(), 1u);
    }
  };
  wire_->run(16s);  // still refused, but read alone, so no other point is affected
  EXPECT_EQ(wire_->bad.size(), 2u);
  wire_->check = nullptr;
  holes_.clear();
  wire_->run(30s);
  wire_->forget_gaps();
  wire_->run(20s);
  EXPECT_GE(wire_->seen(7).count, 20u);
  EXPECT_LE(wire_->blocks(), 24u);  // one block again, with a period of 0.86 s
}

TEST_F(RefusingDevice, BarrierIsForgottenAfterAWhile) {
  holes_ = {15};
  wire_->forget = 30s;
  wire_->run(20s);
  holes_.clear();
  wire_->run(20s);
  wire_->forget_gaps();
  wire_->run(20s);
  EXPECT_LE(wire_->blocks(), 24u);
}

TEST_F(RefusingDevice, DeviceThatRefusesEverythingIsLeftAloneInTheEnd) {
  for (std::uint32_t item = 0; item < 40; ++item) holes_.insert(item);
  wire_->run(10s);
  EXPECT_EQ(wire_->bad.size(), 20u);
  EXPECT_LE(refused_, 39u);
  EXPECT_GT(std::get<Rest>(scheduler_->next(wire_->now())).until, wire_->now() + 500s);
}

class RefusalSearchTest : public ::testing::Test {
 protected:
  static constexpr Duration kForget = 60s;
  void cut(const std::vector<OrderIndex>& refused) {
    search_.cut(points_, refused, Instant{}, kForget);
  }
  std::vector<PointState> points_{16};
  RefusalSearch search_;
};

TEST_F(RefusalSearchTest, OnlyPointsThatAreReadAreSuspect) {
  points_[1].mode = Mode::kOnDemand;
  points_[2].bad = true;
  points_[3].readable = false;
  cut({0, 1, 2, 3});
  EXPECT_TRUE(points_[0].suspect);
  for (const OrderIndex index : {1u, 2u, 3u}) EXPECT_FALSE(points_[index].suspect) << index;
}

TEST_F(RefusalSearchTest, ASuspectThatIsNoLongerReadDoesNotHoldUpTheSearch) {
  cut({0, 1, 2, 3});
  search_.mark_bad(points_, 0, Instant{}, kForget);
  for (const OrderIndex index : {1u, 2u}) points_[index].suspect = false;
  search_.settle(points_, 0, 4);
  EXPECT_TRUE(search_.searching()) << "for the last one";
  points_[3].mode = Mode::kOnDemand;
  search_.settle(points_, 0, 4);
  EXPECT_FALSE(search_.searching());
  EXPECT_EQ(points_[2].cut_until, Instant{}) << "the bad point explains the refusal";
}

TEST_F(RefusalSearchTest, ABadPointExplainsOnlyTheRefusalOfItsBlock) {
  cut({4, 5});
  cut({8, 9});
  search_.mark_bad(points_, 8, Instant{}, kForget);
  for (PointState& point : points_) point.suspect = false;
  search_.settle(points_, 0, 16);
  EXPECT_FALSE(search_.searching());
  EXPECT_EQ(points_[5].cut_until, Instant{} + kForget) << "a gap that the device refuses";
  EXPECT_EQ(points_[9].cut_until, Instant{});
}

TEST_F(RefusalSearchTest, TheOldestOfTooManySearchesEnds) {
  cut({10, 11});
  for (int i = 0; i < 256; ++i) cut({0, 1});
  for (const OrderIndex index : {0u, 1u}) points_[index].suspect = false;
  search_.settle(points_, 0, 2);
  EXPECT_FALSE(search_.searching());
}

}  // namespace
}  // namespace fieldcast::test

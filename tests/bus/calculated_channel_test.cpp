#include <gtest/gtest.h>

#include <memory>

#include "core/bus/command/channel_table.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

class CalculatedChannelTest : public testing::Test {
 protected:
  static BusSpec bus() {
    ChannelSpec power;
    power.name = "power";
    power.refresh = 1s;
    power.encoding.type = ValueType::kFloat64;
    power.calculation.value = std::make_shared<Calculation>();
    BusSpec bus;
    bus.devices.emplace_back();
    bus.devices.back().channels.push_back(std::move(power));
    return bus;
  }

  const BusSpec bus_ = bus();
  ChannelTable table_{bus_};
  std::vector<Sample> out_;
};

Calculated result(double value, Duration acquired, Quality quality = Quality::kGood) {
  return {.value = value, .quality = quality, .acquired = Instant{acquired}};
}

TEST_F(CalculatedChannelTest, ASampleHasTheTimeOfItsInputs) {
  table_.calculated(0, result(7, 1s), Instant{2s}, out_);
  ASSERT_EQ(out_.size(), 1u);
  EXPECT_EQ(out_[0].value, Value{7.0});
  EXPECT_EQ(out_[0].acquired, Instant{1s});
  EXPECT_EQ(out_[0].sequence, 1u);
}

TEST_F(CalculatedChannelTest, ReportsABadInputOnceAndKeepsItsValue) {
  table_.calculated(0, result(0, 0s, Quality::kNotYetRead), Instant{1s}, out_);
  EXPECT_TRUE(out_.empty()) << "there was no value";
  table_.calculated(0, result(7, 1s), Instant{1s}, out_);
  table_.calculated(0, result(0, 1s, Quality::kBadFrame), Instant{2s}, out_);
  table_.calculated(0, result(0, 1s, Quality::kBadFrame), Instant{3s}, out_);
  ASSERT_EQ(out_.size(), 2u);
  EXPECT_EQ(out_[1].quality, Quality::kBadFrame);
  EXPECT_EQ(out_[1].value, Value{7.0});
  EXPECT_EQ(out_[1].acquired, Instant{1s});
  table_.calculated(0, result(0, 0s, Quality::kNotYetRead), Instant{4s}, out_);
  EXPECT_EQ(out_.back().quality, Quality::kUncertain) << "an old value without its input";
}

TEST_F(CalculatedChannelTest, ADeadbandHoldsBackWhatIsCalculated) {
  BusSpec quiet = bus();
  quiet.devices[0].channels[0].deadband = 5;
  quiet.devices[0].channels[0].heartbeat = 1h;
  ChannelTable table(quiet);
  table.calculated(0, result(7, 1s), Instant{1s}, out_);
  table.calculated(0, result(12, 2s), Instant{2s}, out_);
  EXPECT_EQ(out_.size(), 1u);
  table.calculated(0, result(13, 3s), Instant{3s}, out_);
  ASSERT_EQ(out_.size(), 2u);
  EXPECT_EQ(out_[1].value, Value{13.0});
}

// Its inputs report a miss at 1003 ms. It does so itself only if they do not, for example because
// the thread of their bus hangs.
TEST_F(CalculatedChannelTest, IsUncertainSoonAfterItsInputsAreLate) {
  table_.start(Instant{});
  table_.calculated(0, result(7, 0s), Instant{}, out_);
  table_.expire(Instant{1050ms}, out_);
  ASSERT_EQ(out_.size(), 1u);
  table_.expire(Instant{1200ms}, out_);
  ASSERT_EQ(out_.size(), 2u);
  EXPECT_EQ(out_[1].quality, Quality::kUncertain);
}

TEST_F(CalculatedChannelTest, TheWireOfABusDoesNotDecideItsCalculatedChannels) {
  table_.start(Instant{});
  table_.calculated(0, result(7, 0s), Instant{}, out_);
  table_.failing(0, Cause::kPortClosed, Instant{1s});
  table_.all_uncertain(Instant{1s}, out_);
  EXPECT_EQ(out_.size(), 1u);
  table_.calculated(0, result(8, 1s), Instant{1s}, out_);
  EXPECT_EQ(out_.back().quality, Quality::kGood);
}

}  // namespace
}  // namespace fieldcast

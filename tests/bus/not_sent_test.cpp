// Tests requests that the bridge withheld because another master may hold the wire. The device owes
// no response, and a command runs later or expires.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/bus/rtu_bus.hpp"
#include "tests/bus/shared_wire.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

class NotSentTest : public testing::Test {
 protected:
  static constexpr std::uint8_t kRead = 3;  // holding registers

  void SetUp() override {
    wire_.may_send = [this](std::size_t) { return may_send_; };
    wire_.on_action = [this](std::size_t, const Action& action) {
      if (const auto* complete = std::get_if<Complete>(&action)) results_.push_back(*complete);
      const auto* send = std::get_if<Send>(&action);
      if (send == nullptr) return;
      ++decided_;
      if (may_send_) functions_.push_back(send->bytes[1]);
    };
    wire_.open(0);
    pass(1s);
  }
  static BusSpec bus() {
    BusSpec spec = rtu_bus(1);
    spec.echo = false;
    spec.devices[0].retries = 1;
    return spec;
  }
  void pass(Duration time) { wire_.run_until(wire_.now() + time); }
  void write(std::string channel, Duration until) {
    Command command;
    command.request_id = 1;
    command.device = "unit-1";
    command.target = ChannelTarget{std::move(channel)};
    command.values = {Value{std::uint64_t{7}}};
    command.expires = wire_.now() + until;
    wire_.feed(0, CommandArrived{command});
  }
  BusEngine& engine() { return wire_.master(0).engine; }
  DeviceReport device() { return engine().device_report(0, wire_.now()); }
  std::ptrdiff_t writes() const {
    return std::count_if(functions_.begin(), functions_.end(), [](auto f) { return f != kRead; });
  }

  SharedWire wire_{bus(), {Adapter{}}, {}, 1};
  bool may_send_ = true;
  std::vector<Complete> results_;
  unsigned decided_ = 0;
  std::vector<std::uint8_t> functions_;  // function codes of the sent requests
};

TEST_F(NotSentTest, TheDeviceIsNotBlamed) {
  const DeviceReport before = device();
  const BusReport bus_before = engine().bus_report(wire_.now());
  may_send_ = false;
  pass(5s);
  const DeviceReport after = device();
  const BusReport bus_after = engine().bus_report(wire_.now());
  EXPECT_EQ(after.state, DeviceState::kOnline);
  EXPECT_EQ(after.failures, before.failures);
  EXPECT_EQ(after.causes.total(), before.causes.total());
  EXPECT_EQ(after.exchanges, before.exchanges);
  EXPECT_EQ(bus_after.exchanges, bus_before.exchanges);
  EXPECT_EQ(bus_after.bytes_sent, bus_before.bytes_sent);
  may_send_ = true;
  pass(2s);
  EXPECT_GT(device().exchanges, before.exchanges);
  EXPECT_EQ(device().failures, before.failures);
}

TEST_F(NotSentTest, TheBridgeTriesNowAndThenOnly) {
  may_send_ = false;
  pass(1s);
  decided_ = 0;
  pass(1s);
  EXPECT_GT(decided_, 10u);
  EXPECT_LE(decided_, 1s / Wire::kNotSentRest + 1);
}

TEST_F(NotSentTest, ACommandRunsOnceThatIsPossible) {
  may_send_ = false;
  write("r0", 10s);
  pass(1s);
  EXPECT_TRUE(results_.empty());
  EXPECT_EQ(writes(), 0);
  may_send_ = true;
  pass(1s);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].result.state, CommandState::kDone);
  EXPECT_EQ(writes(), 1);
}

TEST_F(NotSentTest, ACommandThatNeverLeftExpires) {
  may_send_ = false;
  write("r0", 2s);
  pass(3s);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].result.state, CommandState::kExpired);
  may_send_ = true;
  pass(2s);
  EXPECT_EQ(results_.size(), 1u);
  EXPECT_EQ(writes(), 0);
}

TEST_F(NotSentTest, ACommandThatNeverLeftIsRefusedWithoutDoubt) {
  may_send_ = false;
  write("r0", 10s);
  pass(1s);
  wire_.feed(0, StopRequested{});
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].result.state, CommandState::kRejected);
  EXPECT_EQ(results_[0].result.cause, Cause::kShutdown);
}

// The device may still respond to the first try, so the read is not simply asked again.
TEST_F(NotSentTest, ASecondTryThatNeverLeftEndsTheRead) {
  const auto given_up = [&] {
    return engine().bus_report(wire_.now()).causes[Cause::kForeignMaster];
  };
  wire_.cut(0, true);
  decided_ = 0;
  while (decided_ == 0) pass(1ms);
  may_send_ = false;
  EXPECT_EQ(given_up(), 0u);
  while (decided_ == 1) pass(1ms);
  EXPECT_EQ(given_up(), 1u);
  EXPECT_EQ(device().failures, 0u);
}

// The read-back is withheld, so the write must not be repeated before the device was read.
TEST_F(NotSentTest, AWriteThatLeftIsReadBackBeforeItIsWrittenAgain) {
  wire_.cut(0, true);
  write("r0", 10s);
  while (writes() == 0) pass(1ms);
  may_send_ = false;
  wire_.cut(0, false);
  pass(3s);
  EXPECT_TRUE(results_.empty());
  const std::size_t before = functions_.size();
  may_send_ = true;
  pass(1s);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].result.state, CommandState::kDone);
  EXPECT_EQ(functions_.at(before), kRead);
  EXPECT_EQ(writes(), 2);
}

}  // namespace
}  // namespace fieldcast::test

#include "core/program/engineer.hpp"

#include <gmock/gmock.h>

#include "tests/program/engineer_bench.hpp"

namespace fieldcast::program {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Bench = EngineerBench;

TEST(Engineer, ARequestGetsAResponseAndBytesPassBothWays) {
  Bench b;
  b.sends("@@17FEFF");
  EXPECT_THAT(b.taken, ElementsAre("17"));
  b.tell(DeviceGiven{});
  EXPECT_EQ(b.received(), "@@0000FEFF");
  b.sends("@@@00FA0FEFF*\rFEFF");
  EXPECT_EQ(b.reached(), "@00FA0FEFF*\r");
  b.answers("@00FA00*");
  EXPECT_EQ(b.received(), "");
  b.answers("\r");
  EXPECT_EQ(b.received(), "@@@00FA00*\rFEFF");
  EXPECT_EQ(b.engineer.bytes_to_device(), 12u);
  EXPECT_EQ(b.engineer.bytes_from_device(), 9u);
}

TEST(Engineer, RefusalsHaveTheirReplyAndTheClientMayAskAgain) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(DeviceRefused{Reply::kNotOnline, ""});
  EXPECT_EQ(b.received(), "@@0001FEFF");
  b.sends("@@18FEFF");
  b.tell(DeviceRefused{Reply::kInUse, ""});
  EXPECT_EQ(b.received(), "@@0002FEFF");
  b.sends("@@press 1FEFF");
  EXPECT_EQ(b.received(), "@@0001FEFF");
  b.sends("@@19FEFF");
  b.tell(DeviceGiven{});
  EXPECT_EQ(b.received(), "@@0000FEFF");
  EXPECT_THAT(b.taken, ElementsAre("17", "18", "19"));
}

TEST(Engineer, ADeviceThatIsLostBeforeItIsGivenIsNotOnline) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(DeviceLost{"unplugged"});
  EXPECT_EQ(b.received(), "@@0001FEFF");
  EXPECT_EQ(b.freed, 1) << "others may request it";
  b.pair("@@18FEFF");
}

TEST(Engineer, OnlySoManyRequestsAreRefused) {
  Bench b;
  for (unsigned i = 0; i < Engineer::kMaxRefused; ++i) {
    EXPECT_EQ(b.hung_up, 0);
    b.sends("@@?FEFF");
  }
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_TRUE(b.engineer.over());
}

TEST(Engineer, StopReleasesTheDeviceAndAnotherCanBeAskedFor) {
  Bench b;
  b.pair();
  b.sends("@@EDFEFF@@18FEFF");
  EXPECT_EQ(b.received(), "") << "it knows that it has stopped";
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 0);
  EXPECT_THAT(b.taken, ElementsAre("17", "18"));
}

TEST(Engineer, TheLossOfTheDeviceIsReportedAndFreesIt) {
  Bench b;
  b.pair();
  b.answers("@00FA");
  b.tell(DeviceLost{"closed by the peer"});
  EXPECT_EQ(b.received(), "@@0003FEFF");
  EXPECT_EQ(b.freed, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("closed by the peer"));
  EXPECT_FALSE(b.engineer.over());
  b.sends("@@@00late*\rFEFF");  // was in flight
  EXPECT_EQ(b.reached(), "");
  EXPECT_EQ(b.received(), "");
  b.sends("@@17FEFF");
  b.tell(DeviceGiven{});
  EXPECT_EQ(b.received(), "@@0000FEFF");
}

TEST(Engineer, TheLossOfTheClientFreesTheDevice) {
  Bench b;
  b.pair();
  b.tell(ClientGone{"reset"});
  EXPECT_EQ(b.freed, 1);
  EXPECT_TRUE(b.engineer.over());
}

TEST(Engineer, AClientThatClosesBeforeTheDeviceIsGivenLeavesNothingTaken) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(ClientGone{"reset"});
  EXPECT_EQ(b.freed, 1);
  b.tell(DeviceGiven{});
  EXPECT_FALSE(b.engineer.paired());
}

TEST(Engineer, AStopThatNothingFollowsReleasesTheDeviceAnyway) {
  Bench b;
  b.pair();
  b.sends("@@EDFEFF");
  EXPECT_EQ(b.freed, 0);
  b.pass(milliseconds{201});
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.last_remark(), "stopped by the engineer");
  EXPECT_EQ(b.hung_up, 0);
}

TEST(Engineer, AClientThatStopsAndLeavesHasStopped) {
  Bench b;
  b.pair();
  b.sends("@@EDFEFF");
  b.tell(ClientGone{"closed by the peer"});
  EXPECT_EQ(b.freed, 1);
  EXPECT_TRUE(b.engineer.over());
  EXPECT_THAT(b.remarks,
              testing::Contains(testing::Field(&Remark::text, "stopped by the engineer")));
}

TEST(Engineer, GarbageBeforeTheHandshakeIsBoundedAndReported) {
  Bench b;
  b.sends("GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kDropped);
  EXPECT_FALSE(b.engineer.over());
  b.sends(std::string(Engineer::kMaxNoise, 'x'));
  EXPECT_TRUE(b.engineer.over());
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_THAT(b.taken, IsEmpty());
}

TEST(Engineer, NoiseWithinAPairingIsBoundedAndEarlierNoiseDoesNotCount) {
  Bench b;
  b.sends(std::string(Engineer::kMaxNoise, 'x'));
  b.pair();
  b.sends(std::string(Engineer::kMaxNoiseLater, 'x'));
  EXPECT_FALSE(b.engineer.over());
  EXPECT_EQ(b.freed, 0);
  b.sends("x");
  EXPECT_TRUE(b.engineer.over());
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, WhoFloodsInsteadOfWaitingForTheReplyIsHungUp) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(FromClient{Bytes(Engineer::kMaxEarly + 1, 'x')});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.freed, 1);
}

TEST(Engineer, TheBridgesEndIsReportedToAClient) {
  Bench b;
  b.pair();
  b.tell(Ended{"the bridge stops"});
  EXPECT_EQ(b.received(), "@@0003FEFF");
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, CodesOfAnEarlierPairingAreIgnoredInTheHandshake) {
  Bench b;
  b.sends("@@HBFEFF@@EDFEFF");
  EXPECT_EQ(b.received(), "");
  EXPECT_FALSE(b.engineer.over());
  b.sends("@@AU17FEFF");  // without the colon of a login
  EXPECT_THAT(b.logins, IsEmpty());
  EXPECT_THAT(b.taken, ElementsAre("AU17"));
}

TEST(Engineer, EventsThatNoRequestAwaitsChangeNothing) {
  Bench b;
  for (const EngineerEvent& late :
       {EngineerEvent{LoginChecked{true, ""}}, EngineerEvent{DeviceGiven{}},
        EngineerEvent{DeviceRefused{Reply::kInUse, ""}}, EngineerEvent{DevicesListed{}},
        EngineerEvent{FromDevice{as_bytes("late\r")}}, EngineerEvent{DeviceLost{"late"}},
        EngineerEvent{LineChanged{}}, EngineerEvent{LineState{}}, EngineerEvent{ClientDrains{}},
        EngineerEvent{DeviceDrains{}}})
    b.tell(late);
  EXPECT_EQ(b.received(), "");
  EXPECT_THAT(b.remarks, IsEmpty());
  EXPECT_EQ(b.freed + b.hung_up, 0);
  b.pair();
  b.answers("");
  EXPECT_EQ(b.received(), "");
}

TEST(Engineer, TheBridgesEndFreesADeviceThatIsRequested) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(Ended{"the bridge stops"});
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, WhoFloodsDuringTheCheckOfALoginIsHungUp) {
  Bench b;
  b.sends("@@AU616e6e61:736563726574FEFF");
  b.tell(FromClient{Bytes(Engineer::kMaxEarly + 1, 'x')});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.freed, 0) << "no device was requested";
}

}  // namespace
}  // namespace fieldcast::program

// The bridge's end of a pairing in virtual time: replies, time-outs, every way to lose a side.
#include "core/program/engineer.hpp"

#include <gmock/gmock.h>

namespace fieldcast::program {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Feeds events and keeps what came of them.
struct Bench {
  explicit Bench(EngineerRules rules = {}) : engineer(rules, now) { tell(TimerFired{}); }

  void tell(const EngineerEvent& event) {
    EngineerActions actions;
    engineer.on_event(event, now, actions);
    for (EngineerAction& action : actions) {
      if (auto* to = std::get_if<ToClient>(&action)) append(client, to->bytes);
      if (auto* to = std::get_if<ToDevice>(&action)) append(device, to->bytes);
      if (auto* login = std::get_if<CheckLogin>(&action))
        logins.push_back(login->user + '/' + login->password);
      if (auto* take = std::get_if<TakeDevice>(&action)) taken.push_back(take->number);
      if (auto* line = std::get_if<SetLine>(&action)) lines.push_back(line->settings);
      if (std::holds_alternative<FreeDevice>(action)) ++freed;
      if (std::holds_alternative<HangUp>(action)) ++hung_up;
      if (auto* timer = std::get_if<SetTimer>(&action)) wake = timer->at;
      if (auto* remark = std::get_if<Remark>(&action)) remarks.push_back(*remark);
    }
  }
  void sends(std::string_view text) { tell(FromClient{as_bytes(text)}); }
  void answers(std::string_view text) { tell(FromDevice{as_bytes(text)}); }
  // Lets time pass, firing what is due.
  void pass(Duration time) {
    const Instant until = now + time;
    while (wake <= until) {
      now = std::max(now, wake);
      wake = kNever;
      tell(TimerFired{});
    }
    now = until;
  }
  void pair(std::string_view request = "@@17FEFF") {
    sends(request);
    tell(DeviceGiven{});
    ASSERT_TRUE(engineer.paired());
    client.clear();
  }
  std::string received() { return std::string(as_text(std::exchange(client, {}))); }
  std::string reached() { return std::string(as_text(std::exchange(device, {}))); }
  [[nodiscard]] std::string last_remark() const {
    return remarks.empty() ? "" : remarks.back().text;
  }

  Instant now{seconds{1000}};
  Instant wake = kNever;
  Engineer engineer;
  Bytes client, device;
  std::vector<std::string> logins, taken;
  std::vector<LineSettings> lines;
  std::vector<Remark> remarks;
  int freed = 0, hung_up = 0;
};

TEST(Engineer, ARequestIsAnsweredAndBytesPassBothWays) {
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
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 0);
  EXPECT_THAT(b.taken, ElementsAre("17", "18"));
}

TEST(Engineer, TheLossOfTheDeviceIsToldAndFreesIt) {
  Bench b;
  b.pair();
  b.answers("@00FA");
  b.tell(DeviceLost{"closed by the peer"});
  EXPECT_EQ(b.received(), "@@0003FEFF");
  EXPECT_EQ(b.freed, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("closed by the peer"));
  EXPECT_FALSE(b.engineer.over());
  b.sends("@@@00late*\rFEFF");  // was on its way
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

TEST(Engineer, AClientThatIsGoneBeforeTheDeviceIsGivenLeavesNothingTaken) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(ClientGone{"reset"});
  EXPECT_EQ(b.freed, 1);
  b.tell(DeviceGiven{});
  EXPECT_FALSE(b.engineer.paired());
}

TEST(Engineer, HeartbeatsAreSentAndThreeMissedFreeThePairing) {
  Bench b;
  b.pair();
  b.pass(milliseconds{5001});
  EXPECT_EQ(b.received(), "@@HBFEFF");
  b.sends("@@HBFEFF");
  b.pass(seconds{17});
  EXPECT_TRUE(b.engineer.paired());
  b.pass(seconds{1});
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("heartbeats"));
}

TEST(Engineer, APairingWithoutProgramBytesIsFreedAfterItsIdleTime) {
  EngineerRules rules;
  rules.idle = minutes{2};
  Bench b(rules);
  b.pair();
  for (int i = 0; i < 23; ++i) {
    b.pass(seconds{5});
    b.sends("@@HBFEFF");
    ASSERT_TRUE(b.engineer.paired()) << i;
  }
  b.pass(seconds{5});
  EXPECT_EQ(b.freed, 1);
  EXPECT_THAT(b.received(), HasSubstr("@@0003FEFF"));
}

TEST(Engineer, AClientThatNeverSpeaksIsHungUp) {
  Bench b;
  b.pass(milliseconds{9999});
  EXPECT_EQ(b.hung_up, 0);
  b.pass(milliseconds{2});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("no device was asked for"));
}

TEST(Engineer, WhoLogsInAndThenNeverAsksIsHungUp) {
  EngineerRules rules;
  rules.login_needed = true;
  Bench b(rules);
  b.pass(seconds{9});
  b.sends("@@AU616e6e61:736563726574FEFF");
  b.tell(LoginChecked{true, ""});
  b.pass(milliseconds{9999});
  EXPECT_EQ(b.hung_up, 0);
  b.pass(milliseconds{2});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("no device was asked for"));
}

TEST(Engineer, AClientThatNeverReadsIsFreed) {
  Bench b;
  b.pair();
  b.tell(ClientTakes{false});
  const auto send_heartbeats = [&](int times) {
    for (int i = 0; i < times; ++i) {
      b.sends("@@HBFEFF");
      b.pass(seconds{5});
    }
  };
  send_heartbeats(6);
  b.tell(ClientTakes{false});  // still: the clock goes on
  send_heartbeats(5);
  EXPECT_EQ(b.freed, 0);
  send_heartbeats(1);
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, ADeviceThatTakesNoBytesIsLost) {
  Bench b;
  b.pair();
  b.tell(DeviceTakes{false});
  b.pass(seconds{50});
  b.tell(DeviceTakes{true});
  b.tell(DeviceTakes{false});
  b.pass(seconds{59});
  EXPECT_TRUE(b.engineer.paired());
  b.pass(seconds{1});
  EXPECT_EQ(b.freed, 1);
  EXPECT_THAT(b.received(), HasSubstr("@@0003FEFF"));
}

// 200 KiB at 1 920 B/s: 107 s with a full queue, in which the client is not read, nor its
// heartbeats. At 110 B/s even the idle time passes.
TEST(Engineer, ASlowLineThatDrainsIsNeverCut) {
  for (const auto& [step, length] :
       {std::pair{seconds{1}, seconds{107}}, std::pair{seconds{40}, seconds{1900}}}) {
    Bench b;
    b.pair();
    b.sends("@@@00WD*\rFEFF");
    b.tell(DeviceTakes{false});
    for (auto passed = seconds{0}; passed < length; passed += step) {
      b.pass(step);
      b.tell(DeviceDrains{});
      ASSERT_TRUE(b.engineer.paired()) << passed.count() << ": " << b.last_remark();
    }
    b.tell(DeviceTakes{true});
    b.pass(seconds{17});
    EXPECT_TRUE(b.engineer.paired());
    b.pass(seconds{1});  // the client is read again and says nothing
    EXPECT_FALSE(b.engineer.paired());
    EXPECT_THAT(b.last_remark(), HasSubstr("heartbeats"));
  }
}

TEST(Engineer, ASlowClientThatDrainsIsNeverCut) {
  Bench b;
  b.pair();
  b.tell(ClientTakes{false});
  for (int i = 0; i < 300; ++i) {
    b.pass(seconds{4});
    b.sends("@@HBFEFF");
    if (i % 10 == 0) b.tell(ClientDrains{});
    ASSERT_TRUE(b.engineer.paired()) << i << ": " << b.last_remark();
  }
}

TEST(Engineer, AStopThatNothingFollowsReleasesTheDeviceAllTheSame) {
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

TEST(Engineer, AContinuationThatBeginsLikeAControlFrameReachesItsSide) {
  Bench b;
  b.pair();
  b.sends("@@0000FEFF12\rFEFF@@EDFEFF34\rFE");
  b.sends("FF");
  EXPECT_EQ(b.reached(), "0000FEFF12\rEDFEFF34\r");
  b.answers("0000FEFF56\r0003FEFF78*\r");
  EXPECT_EQ(b.received(), "@@0000FEFF56\rFEFF@@0003FEFF78*\rFEFF");
  EXPECT_TRUE(b.engineer.paired());
  EXPECT_THAT(b.remarks.back().kind, Remark::Kind::kPaired);  // nothing was dropped
}

TEST(Engineer, HalfAnInstructionIsDroppedAndReportedNeverSent) {
  Bench b;
  b.pair();
  b.sends("@@@00FA");
  b.pass(milliseconds{1900});
  b.sends("00");
  b.pass(milliseconds{1999});
  EXPECT_THAT(b.remarks.back().kind, Remark::Kind::kPaired);
  b.pass(milliseconds{2});
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kDropped);
  b.sends("@@@00next*\rFEFF");
  EXPECT_EQ(b.reached(), "@00next*\r");
  b.answers("@00half");
  b.pass(milliseconds{2001});
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kDropped);
  b.answers("@00ok*\r");
  EXPECT_THAT(b.received(), HasSubstr("@@@00ok*\rFEFF"));
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

TEST(Engineer, ALoginIsDemandedWhereItIsNeeded) {
  EngineerRules rules;
  rules.login_needed = true;
  Bench b(rules);
  b.sends("@@17FEFF");
  EXPECT_EQ(b.received(), "@@0004FEFF");
  EXPECT_THAT(b.taken, IsEmpty());
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kLoginFailed);
}

TEST(Engineer, ARightLoginOpensTheWayAndAWrongOneClosesIt) {
  EngineerRules rules;
  rules.login_needed = true;
  Bench good(rules), bad(rules);
  for (Bench* b : {&good, &bad})
    b->sends("@@AU616e6e61:736563726574FEFF@@V217FEFF");  // anna, secret
  EXPECT_THAT(good.logins, ElementsAre("anna/secret"));
  EXPECT_THAT(good.taken, IsEmpty());
  good.tell(LoginChecked{true, ""});
  EXPECT_THAT(good.taken, ElementsAre("17"));
  bad.tell(LoginChecked{false, "wrong password"});
  EXPECT_EQ(bad.received(), "@@0004FEFF");
  EXPECT_EQ(bad.hung_up, 1);
  EXPECT_EQ(bad.remarks.back().kind, Remark::Kind::kLoginFailed);
  EXPECT_THAT(bad.taken, IsEmpty());
}

TEST(Engineer, ALoginThatCannotBeReadIsRefused) {
  for (const char* login :
       {"@@AU:FEFF", "@@AU6:6FEFF", "@@AUzz:00FEFF", "@@AU610a62:00FEFF", "@@AU616E6E61:00FEFF"}) {
    Bench b;
    b.sends(login);
    EXPECT_EQ(b.received(), "@@0004FEFF") << login;
    EXPECT_TRUE(b.engineer.over()) << login;
    EXPECT_THAT(b.logins, IsEmpty()) << login;
  }
}

TEST(Engineer, WhoFloodsInsteadOfWaitingForTheReplyIsHungUp) {
  Bench b;
  b.sends("@@17FEFF");
  b.tell(FromClient{Bytes(Engineer::kMaxEarly + 1, 'x')});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.freed, 1);
}

Bytes chunk(std::string_view text) {
  Bytes out;
  append_chunks(out, as_bytes(text));
  return out;
}

TEST(Engineer, FramingByLengthIsNegotiatedAndCarriesAnything) {
  Bench b;
  b.pair("@@V217FEFF");
  b.tell(FromClient{chunk("@@EDFEFF\r\xFF")});
  EXPECT_EQ(b.reached(), "@@EDFEFF\r\xFF");
  b.answers("half of an answer");
  EXPECT_EQ(b.client, chunk("half of an answer"));
  b.client.clear();
  b.pass(milliseconds{5001});
  EXPECT_EQ(b.client, (Bytes{0, 0, 0, 0}));
}

TEST(Engineer, LineSettingsComeBetweenTheBytesAroundThem) {
  Bench b;
  b.pair("@@V217FEFF");
  Bytes stream = chunk("slow");
  append_settings(stream, {115200, 2, 0, Parity::kNone});
  append(stream, chunk("fast"));
  EngineerActions actions;
  b.engineer.on_event(FromClient{stream}, b.now, actions);
  std::string order;
  for (const auto& action : actions) {
    if (auto* to = std::get_if<ToDevice>(&action)) order += std::string(as_text(to->bytes)) + ' ';
    if (auto* line = std::get_if<SetLine>(&action))
      order += std::to_string(line->settings.baud) + ' ';
  }
  EXPECT_EQ(order, "slow 115200 fast ");
}

TEST(Engineer, WithFramingByLengthTheLossIsAStopAndItsReason) {
  Bench b;
  b.pair("@@V217FEFF");
  b.tell(DeviceLost{"gone"});
  Bytes expected{0xFF, 0xFF, 0xFF, 0xFF};
  append(expected, control_frame("0003"));
  EXPECT_EQ(b.client, expected);
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, AStreamThatMakesNoSenseEndsThePairing) {
  Bench b;
  b.pair("@@V217FEFF");
  b.sends("@@17FEFF");  // 40403137h bytes
  EXPECT_EQ(b.freed, 1);
  EXPECT_TRUE(b.engineer.over());
  EXPECT_EQ(b.reached(), "");
}

TEST(Engineer, TheBridgesEndIsToldToAClient) {
  Bench b;
  b.pair();
  b.tell(Ended{"the bridge stops"});
  EXPECT_EQ(b.received(), "@@0003FEFF");
  EXPECT_EQ(b.freed, 1);
  EXPECT_EQ(b.hung_up, 1);
}

}  // namespace
}  // namespace fieldcast::program

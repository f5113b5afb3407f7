#include <gmock/gmock.h>

#include "tests/program/engineer_bench.hpp"

namespace fieldcast::program {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Bench = EngineerBench;

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

void expect_hung_up_in_ten_seconds(Bench& b) {
  b.pass(milliseconds{9999});
  EXPECT_EQ(b.hung_up, 0);
  b.pass(milliseconds{2});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("no device was asked for"));
}

TEST(Engineer, AClientThatNeverSpeaksIsHungUp) {
  Bench b;
  expect_hung_up_in_ten_seconds(b);
}

TEST(Engineer, ARefusedClientHasTheWholeTimeForItsNextRequest) {
  Bench b;
  b.pass(seconds{6});
  b.sends("@@?FEFF");
  EXPECT_EQ(b.received(), "@@0001FEFF");
  expect_hung_up_in_ten_seconds(b);
}

TEST(Engineer, WhoLogsInAndThenNeverAsksIsHungUp) {
  EngineerRules rules;
  rules.login_needed = true;
  Bench b(rules);
  b.pass(seconds{9});
  b.sends("@@AU616e6e61:736563726574FEFF");
  b.tell(LoginChecked{true, ""});
  expect_hung_up_in_ten_seconds(b);
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
  b.tell(ClientTakes{false});  // the client still does not read
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

// 200 KiB at 1 920 B/s: 107 s with a full queue, in which the client and its heartbeats are not
// read. At 110 B/s even the idle time passes.
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
    b.pass(seconds{1});  // the client is read again and sends nothing
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

using Bench = EngineerBench;

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

TEST(Engineer, ACertificateIsTheLoginOnceItsUserIsFound) {
  EngineerRules rules;
  rules.login_needed = rules.by_certificate = true;
  Bench good(rules), bad(rules);
  for (Bench* b : {&good, &bad}) {
    b->sends("@@V217FEFF");
    EXPECT_THAT(b->taken, IsEmpty()) << "before it is known who it is";
  }
  good.tell(LoginChecked{true, ""});
  EXPECT_THAT(good.taken, ElementsAre("17"));
  bad.tell(LoginChecked{false, "no such user"});
  EXPECT_EQ(bad.received(), "@@0004FEFF");
  EXPECT_EQ(bad.hung_up, 1);
  EXPECT_THAT(bad.taken, IsEmpty());
}

TEST(Engineer, ALoginHasAtMost128CharactersOfEach) {
  const auto login = [](std::size_t user, std::size_t password) {
    Bench b;
    b.sends("@@AU" + hex_of_text(std::string(user, 'u')) + ':' +
            hex_of_text(std::string(password, 'p')) + "FEFF");
    return b.logins.size();
  };
  EXPECT_EQ(login(128, 128), 1u);
  EXPECT_EQ(login(129, 128), 0u);
  EXPECT_EQ(login(128, 129), 0u);
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

TEST(Engineer, AClientThatNeverReadsIsHungUpBeforeItIsPaired) {
  EngineerRules rules;
  rules.handshake = std::chrono::minutes{10};
  Bench b(rules);
  b.tell(ClientTakes{false});
  b.pass(Engineer::kStuckWait + milliseconds{1});
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.freed, 0);
  EXPECT_THAT(b.last_remark(), HasSubstr("the client takes no bytes for"));
}

TEST(Engineer, AClientThatReadsAgainStaysPaired) {
  Bench b;
  b.pair();
  b.tell(ClientTakes{false});
  b.tell(ClientTakes{true});
  for (int i = 0; i < 20; ++i) {
    b.sends("@@HBFEFF");
    b.pass(seconds{5});
  }
  EXPECT_EQ(b.freed, 0);
}

}  // namespace
}  // namespace fieldcast::program

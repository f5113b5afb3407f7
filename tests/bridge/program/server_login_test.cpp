#include "bridge/program/engineer_server.hpp"
#include "tests/bridge/program/program_support.hpp"

namespace fieldcast {
namespace {

using test::TcpClient;

using ProgramServer = test::ServerFixture;

TEST_F(ProgramServer, AWrongPasswordIsRefusedAndAudited) {
  start();
  TcpClient client = engineer();
  client.send("@@AU616e6e61:00FEFF@@17FEFF");
  EXPECT_EQ(client.receive("FEFF"), "@@0004FEFF");
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(audited("login refused: user anna: wrong password"));
}

TEST_F(ProgramServer, ALoginNamesTheUserInTheAudit) {
  start();
  TcpClient module = this->module("17\n");
  TcpClient client = engineer();
  client.send("@@AU616e6e61:736563726574FEFF");
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");
  EXPECT_TRUE(audited("paired"));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(audit.back().who, testing::StartsWith("anna (127.0.0.1:"));
}

TEST_F(ProgramServer, ALoginCanBeDemandedOnTheLoopbackToo) {
  spec.engineers->login = LoginRule::kAlways;
  start();
  TcpClient module = this->module("17\n");
  TcpClient nobody = engineer();
  nobody.send("@@17FEFF");
  EXPECT_EQ(nobody.receive("FEFF"), "@@0004FEFF");
  EXPECT_TRUE(nobody.is_closed());
  EXPECT_TRUE(audited("was asked for without a login"));
  TcpClient anna = engineer();
  anna.send("@@AU616e6e61:736563726574FEFF");
  EXPECT_EQ(pair(anna, "17"), "@@0000FEFF");
}

TEST(ProgramServerRules, OffTheLoopbackALoginIsDemanded) {
  EngineersSpec spec;
  for (const char* host : {"127.0.0.1", "127.1.2.3", "::1"}) {
    spec.listen.host = host;
    spec.login = LoginRule::kOffLoopback;
    EXPECT_FALSE(program::rules_of(spec).login_needed) << host;
    spec.login = LoginRule::kAlways;
    EXPECT_TRUE(program::rules_of(spec).login_needed) << host;
  }
  spec.login = LoginRule::kOffLoopback;
  for (const char* host : {"0.0.0.0", "10.0.0.7", "::", "192.168.127.1", "127.0.0.1.example.com"}) {
    spec.listen.host = host;
    EXPECT_TRUE(program::rules_of(spec).login_needed) << host;
  }
}

}  // namespace
}  // namespace fieldcast

#include "bridge/program/server.hpp"

#include "bridge/program/engineer_server.hpp"
#include "core/program/frame.hpp"
#include "tests/bridge/program/program_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using ProgramServer = ServerFixture;

TEST_F(ProgramServer, AnEngineerReachesAModuleThatDialledIn) {
  start();
  TcpClient module = this->module("17\r\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "17", client), "@@0000FEFF");
  client->send("@@@00RD00000001*\rFEFF");
  EXPECT_EQ(module.receive("\r"), "@00RD00000001*\r");
  module.send("@00RD00FEFF*\r");
  EXPECT_EQ(client->receive("\rFEFF"), "@@@00RD00FEFF*\rFEFF");
  client->send("@@EDFEFF");
  EXPECT_TRUE(audited("stopped by the engineer"));
  const std::lock_guard lock(mutex);
  EXPECT_EQ(audit.back().bytes_to_device, 15u);
  EXPECT_EQ(audit.back().bytes_from_device, 13u);
  EXPECT_EQ(audit.back().target, "dial-in/17");
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_EQ(reports.front().state, ProgramSessionState::kOpen);
  EXPECT_EQ(reports.back().state, ProgramSessionState::kClosed);
}

TEST_F(ProgramServer, FramingByLengthCarriesAllByteValuesBothWays) {
  start();
  TcpClient module = this->module("17\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "V217", client), "@@0000FEFF");
  Bytes all(1024);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  Bytes chunk;
  program::append_chunks(chunk, all);
  client->send(chunk);
  EXPECT_EQ(module.receive_bytes(all.size()), std::string(all.begin(), all.end()));
  module.send(all);
  std::string back;
  while (back.size() < all.size()) {
    const std::string head = client->receive_bytes(4);
    ASSERT_EQ(head.size(), 4u);
    const std::size_t length = read_u32(program::as_bytes(head));
    const std::string part = client->receive_bytes(length);
    ASSERT_EQ(part.size(), length);
    back += part;
  }
  EXPECT_EQ(back, std::string(all.begin(), all.end()));
}

TEST_F(ProgramServer, AnUnknownDeviceIsNotOnline) {
  start();
  TcpClient client = engineer();
  client.send("@@4711FEFF");
  EXPECT_EQ(client.receive("FEFF"), "@@0001FEFF");
  EXPECT_TRUE(audited("refused: no device of this number"));
}

TEST_F(ProgramServer, ASecondEngineerIsNotifiedThatTheDeviceIsInUse) {
  start();
  TcpClient module = this->module("17\n");
  std::unique_ptr<TcpClient> first;
  ASSERT_EQ(paired(server.engineers_port(), "17", first), "@@0000FEFF");
  TcpClient second = engineer();
  second.send("@@17FEFF");
  EXPECT_EQ(second.receive("FEFF"), "@@0002FEFF");
  EXPECT_TRUE(audited("refused: in use by 127.0.0.1"));
  first->send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  EXPECT_EQ(pair(second, "17"), "@@0000FEFF");
}

TEST_F(ProgramServer, ADeviceLostInMidTransferIsReportedAndFreed) {
  start();
  std::unique_ptr<TcpClient> client;
  {
    TcpClient module = this->module("17\n");
    ASSERT_EQ(paired(server.engineers_port(), "17", client), "@@0000FEFF");
    client->send("@@@00hello*\rFEFF");
    ASSERT_EQ(module.receive("\r"), "@00hello*\r");
    module.send("@00half");
  }
  EXPECT_EQ(client->receive("FEFF"), "@@0003FEFF");
  EXPECT_TRUE(audited("the device is lost"));
  client->send("@@17FEFF");
  EXPECT_EQ(client->receive("FEFF"), "@@0001FEFF");
  TcpClient again = this->module("17\n");
  EXPECT_EQ(pair(*client, "17"), "@@0000FEFF");
}

TEST_F(ProgramServer, AModuleThatDialsInAgainMayReplaceItsOldConnection) {
  spec.modules->second = SecondModule::kReplace;
  start();
  TcpClient old = this->module("17\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "17", client), "@@0000FEFF");
  TcpClient fresh = this->module("17\n");
  EXPECT_EQ(client->receive("FEFF"), "@@0003FEFF");
  EXPECT_TRUE(old.is_closed());
  ASSERT_EQ(pair(*client, "17"), "@@0000FEFF");
  client->send("@@@00x*\rFEFF");
  EXPECT_EQ(fresh.receive("\r"), "@00x*\r");
}

TEST_F(ProgramServer, StoppingNotifiesEveryClient) {
  start();
  TcpClient module = this->module("17\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "17", client), "@@0000FEFF");
  server.stop();
  EXPECT_EQ(client->receive("FEFF"), "@@0003FEFF");
  EXPECT_TRUE(client->is_closed());
  EXPECT_TRUE(module.is_closed());
}

TEST_F(ProgramServer, AReloadKeepsItsModulesThoseWithoutANumberYetToo) {
  start();
  TcpClient module = this->module("17\n"), half = this->module("1");
  TcpClient before = engineer();
  ASSERT_EQ(pair(before, "17"), "@@0000FEFF");
  server.stop(program::Server::Modules::kKeep);
  EXPECT_EQ(before.receive("FEFF"), "@@0003FEFF");
  spec.engineers->idle = seconds{77};
  start();
  TcpClient client = engineer();
  EXPECT_EQ(pair(client, "17"), "@@0000FEFF");
  client.send("@@@00x*\rFEFF");
  EXPECT_EQ(module.receive("\r"), "@00x*\r");

  server.stop(program::Server::Modules::kKeep);
  spec.modules->registration.prefix = "ID=";  // the prefix for new registrations
  spec.modules->listen.host = "127.0.0.2";
  start();
  half.send("8\n");
  TcpClient again = engineer(), other = engineer();
  EXPECT_EQ(pair(again, "17"), "@@0000FEFF");
  EXPECT_EQ(pair(other, "18"), "@@0000FEFF");

  server.stop(program::Server::Modules::kKeep);
  spec.modules.reset();
  start();
  EXPECT_TRUE(module.is_closed());
}

TEST_F(ProgramServer, AnAddressThatIsTakenIsAnErrorInWords) {
  start();
  spec.engineers->listen.port = server.engineers_port();
  DialInRegistry other;
  program::Server second({}, other);
  const auto started = second.start(spec);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error(), testing::HasSubstr("cannot listen at 127.0.0.1:"));
}

using ProgramServer = ServerFixture;

TEST_F(ProgramServer, AModuleWithoutANumberIsTurnedAwayAndAudited) {
  start();
  TcpClient garbage = this->module("\x01\x02\x03 what?\r\n");
  EXPECT_TRUE(garbage.is_closed());
  EXPECT_TRUE(audited("module turned away"));
}

TEST_F(ProgramServer, AClientThatSendsNoiseIsHungUpAndAudited) {
  start();
  TcpClient client = engineer();
  client.send(std::string(1000, 'x'));
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(audited("noise instead of frames"));
}

TEST_F(ProgramServer, HalfAnInstructionIsAuditedAndTheNextOneArrives) {
  start();
  TcpClient module = this->module("17\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "17", client), "@@0000FEFF");
  client->send("@@@00half");
  EXPECT_TRUE(audited("half an instruction"));
  client->send("@@@00whole*\rFEFF");
  EXPECT_EQ(module.receive("\r"), "@00whole*\r");
}

TEST_F(ProgramServer, AClientThatLeavesInTheMiddleOfAnInstructionFreesTheDevice) {
  start();
  TcpClient module = this->module("17\n");
  const std::pair<const char*, Bytes> halves[] = {{"17", {'@', '@', '@', '0', '0', 'h'}},
                                                  {"V217", {0, 0, 0}}};
  for (const auto& [request, half] : halves) {
    std::unique_ptr<TcpClient> client, next;
    ASSERT_EQ(paired(server.engineers_port(), request, client), "@@0000FEFF") << request;
    client->send(half);
    client->close();
    const auto end = std::chrono::steady_clock::now() + seconds{10};
    while (paired(server.engineers_port(), "17", next) == "@@0002FEFF" &&
           std::chrono::steady_clock::now() < end) {}
    next->send("@@@00next*\rFEFF");
    EXPECT_EQ(module.receive("\r"), "@00next*\r") << request;
    next->send("@@EDFEFF@@nobody1FEFF");  // the refusal arrives when the device is free again
    EXPECT_EQ(next->receive("FEFF"), "@@0001FEFF");
  }
  EXPECT_TRUE(audited("ended: the client disconnected"));
}

TEST_F(ProgramServer, AClientThatNeverSpeaksOrOnlyHalfARequestIsHungUpAndAudited) {
  spec.engineers->handshake = milliseconds{100};
  start();
  TcpClient silent = engineer(), half = engineer();
  half.send("@@1");
  EXPECT_TRUE(silent.is_closed());
  EXPECT_TRUE(half.is_closed());
  const auto lines = [this] {
    return std::count_if(audit.begin(), audit.end(), [](const auto& entry) {
      return entry.result == "ended: no device was asked for within 100ms" && !entry.who.empty();
    });
  };
  std::unique_lock lock(mutex);
  EXPECT_TRUE(changed.wait_for(lock, seconds{10}, [&] { return lines() == 2; })) << lines();
}

TEST_F(ProgramServer, ARequestIsReadBehindALittleGarbage) {
  start();
  TcpClient module = this->module("17\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "17", client), "@@0000FEFF");
  client->send("@@EDFEFF@@nobody1FEFF");
  ASSERT_EQ(client->receive("FEFF"), "@@0001FEFF");
  TcpClient noisy = engineer();
  noisy.send("AT+CWMODE=1\r\n@@17FEFF");
  EXPECT_EQ(noisy.receive("FEFF"), "@@0000FEFF");
  EXPECT_TRUE(audited("dropped: bytes outside of any frame"));
}

// The server limits the buffer of the client, then disconnects it and frees the device.
TEST_F(ProgramServer, AClientThatNeverReadsIsFreed) {
  spec.engineers->heartbeat = seconds{1};  // the client does not send either
  start();
  TcpClient module = this->module("17\n");
  std::unique_ptr<TcpClient> client;
  ASSERT_EQ(paired(server.engineers_port(), "V217", client), "@@0000FEFF");
  const Bytes much(64 * 1024, 'x');
  std::size_t taken = 0;
  for (const auto end = std::chrono::steady_clock::now() + seconds{10};
       std::chrono::steady_clock::now() < end && !client->is_closed(milliseconds{0});) {
    const ssize_t sent = ::send(module.fd(), much.data(), much.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) taken += static_cast<std::size_t>(sent);
    const std::lock_guard lock(mutex);
    if (!audit.empty() && audit.back().result.find("heartbeats") != std::string::npos) break;
  }
  EXPECT_TRUE(audited("heartbeats of the client are missing"));
  EXPECT_LT(taken, 64u << 20);
  std::unique_ptr<TcpClient> next;
  TcpClient again = this->module("17\n");
  EXPECT_EQ(paired(server.engineers_port(), "17", next), "@@0000FEFF");
}

TEST_F(ProgramServer, SixHundredSilentConnectionsLockNobodyOut) {
  start();
  TcpClient module = this->module("17\n");
  TcpClient first = engineer();
  ASSERT_EQ(pair(first, "17"), "@@0000FEFF");
  std::vector<TcpClient> silent;
  for (const std::uint16_t port : {server.engineers_port(), server.modules_port()}) {
    for (int i = 0; i < 300; ++i) {
      const std::string source = "127.0.0." + std::to_string(1 + (i % 3 == 0 ? 0 : i % 200));
      silent.emplace_back(port, source.c_str());
    }
  }
  first.send("@@@00goes on*\rFEFF");
  EXPECT_EQ(module.receive("\r"), "@00goes on*\r");
  TcpClient late = this->module("18\n"), far(server.modules_port(), "127.0.0.250");
  far.send("19\n");
  std::unique_ptr<TcpClient> second, third;  // repeatedly: the modules are queued behind the flood
  EXPECT_EQ(paired(server.engineers_port(), "18", second), "@@0000FEFF");
  EXPECT_EQ(paired(server.engineers_port(), "19", third), "@@0000FEFF");
  EXPECT_TRUE(silent.front().is_closed());
  const std::lock_guard lock(mutex);
  const auto displaced = std::count_if(audit.begin(), audit.end(), [](const auto& entry) {
    return entry.result.find("the oldest is disconnected") != std::string::npos;
  });
  EXPECT_EQ(displaced, 2);  // logged once per port, then counted
}

}  // namespace
}  // namespace fieldcast::test

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

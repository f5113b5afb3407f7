#include "tests/bridge/program/program_support.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::paired;
using test::TcpClient;

using ProgramServer = test::ServerFixture;

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
}  // namespace fieldcast

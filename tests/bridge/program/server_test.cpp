#include "bridge/program/server.hpp"

#include "core/program/frame.hpp"
#include "tests/bridge/program/program_support.hpp"

namespace fieldcast {
namespace {

using std::chrono::seconds;
using test::paired;
using test::TcpClient;

using ProgramServer = test::ServerFixture;

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

TEST_F(ProgramServer, ASecondEngineerIsToldThatTheDeviceIsInUse) {
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

TEST_F(ProgramServer, ADeviceLostInMidTransferIsToldAndFreed) {
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

TEST_F(ProgramServer, AModuleThatDialsInAnewMayReplaceItsOldConnection) {
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

TEST_F(ProgramServer, StoppingTellsEveryClient) {
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

}  // namespace
}  // namespace fieldcast

// Ports of single devices: RFC 2217 and raw bytes to a module that dialled in.
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/captured_log.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/tls_client.hpp"

namespace fieldcast::test {
namespace {

class EngineerPort : public ServerFixture {
 protected:
  EngineerPortSpec& port() {
    if (spec.engineers->ports.empty())
      spec.engineers->ports.push_back({.device = "17", .listen = {"127.0.0.1", 0}});
    return spec.engineers->ports.front();
  }
  // A client of the port, when the module is registered.
  [[nodiscard]] std::unique_ptr<TcpClient> connect() const {
    return std::make_unique<TcpClient>(server.engineers_port(1));
  }
};

TEST_F(EngineerPort, CarriesRawBytes) {
  port().raw = true;
  start();
  TcpClient module = this->module("17\r\n");
  std::unique_ptr<TcpClient> first;
  ASSERT_EQ(paired(server.engineers_port(), "17", first), "@@0000FEFF");  // registered
  first->send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  const auto client = connect();
  client->send("@00\xFF*\r");
  EXPECT_EQ(module.receive("\r"), "@00\xFF*\r");
  module.send("ok\r");
  EXPECT_EQ(client->receive("\r"), "ok\r");
  EXPECT_TRUE(audited("paired, raw bytes"));
  const auto second = connect();
  EXPECT_TRUE(audited("refused: in use by 127.0.0.1"));
}

TEST_F(EngineerPort, LogsInAtThePromptAsItsUser) {
  port().user = "anna";
  spec.engineers->login = LoginRule::kAlways;
  start();
  const auto other = connect();
  EXPECT_THAT(other->receive("user: "), testing::HasSubstr("user: "));
  other->send("bob\rsecret\r");
  EXPECT_TRUE(audited("login refused: user bob: this port is for anna"));
  const auto wrong = connect();
  wrong->send("anna\rguess\r");
  EXPECT_TRUE(audited("login refused: user anna: wrong password"));
  const auto right = connect();
  right->send("anna\rsecret\r");
  EXPECT_TRUE(audited("logged in"));
  EXPECT_TRUE(audited("no device of this number"));
}

TEST_F(EngineerPort, AnAddressOutsideTheListIsRefused) {
  port().from = {"10.0.0.0/8"};
  start();
  const auto client = connect();
  EXPECT_TRUE(audited("refused: engineers do not connect from this address"));
}

TEST_F(EngineerPort, ACertificateIsTheLoginOfARawPort) {
  Certificates files;
  for (const char* name : {"bridge", "anna", "bob"}) files.issue(name, name);
  spec.engineers->tls = {files.file("bridge.pem"), files.file("bridge.key"), files.file("ca.pem"),
                         ""};
  spec.engineers->proof = LoginProof::kCertificate;
  port().raw = true;
  start();
  SecureClient bob(server.engineers_port(1), files.file("bob"));
  EXPECT_TRUE(audited("login refused: user bob: the role viewer may not program"));
  SecureClient anna(server.engineers_port(1), files.file("anna"));
  EXPECT_TRUE(audited("no device of this number"));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(audit.back().who, testing::StartsWith("anna (127.0.0.1:"));
}

TEST_F(EngineerPort, AnOperatorEndsTheSessionAndTheNextEngineerGetsTheDevice) {
  port().raw = true;
  start();
  TcpClient module = this->module("17\r\n");
  std::unique_ptr<TcpClient> first;
  ASSERT_EQ(paired(server.engineers_port(), "17", first), "@@0000FEFF");  // registered
  EXPECT_FALSE(server.end_session("dial-in", "18", "ended by chen"));
  EXPECT_TRUE(server.end_session("dial-in", "17", "ended by chen: the shift is over"));
  EXPECT_TRUE(audited("ended: ended by chen: the shift is over"));
  (void)first->receive("never");  // until the bridge closes the connection
  EXPECT_FALSE(server.end_session("dial-in", "17", "ended by chen"));
  const auto client = connect();
  ASSERT_TRUE(audited("paired, raw bytes"));
  EXPECT_TRUE(server.end_session("dial-in", "17", "ended by dora"));
  EXPECT_EQ(client->receive("never"), "");
  EXPECT_TRUE(audited("ended: ended by dora"));
}

TEST_F(EngineerPort, TheStopOfTheBridgeEndsTheSession) {
  port().raw = true;
  start();
  TcpClient module = this->module("17\r\n");
  std::unique_ptr<TcpClient> first;
  ASSERT_EQ(paired(server.engineers_port(), "17", first), "@@0000FEFF");  // registered
  first->send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  const auto client = connect();
  ASSERT_TRUE(audited("paired, raw bytes"));
  server.stop();
  EXPECT_TRUE(audited("ended: the bridge stops"));
  EXPECT_EQ(client->receive("never"), "");
}

// Regression: the stop gave up, and destroyed the server that the connection still used.
TEST_F(EngineerPort, TheStopDoesNotWaitForAClientThatReadsNothing) {
  port().raw = true;
  spec.engineers->idle = std::chrono::seconds{1};
  CapturedLog log;
  start();
  TcpClient module = this->module("17\r\n");
  std::unique_ptr<TcpClient> first;
  ASSERT_EQ(paired(server.engineers_port(), "17", first), "@@0000FEFF");  // registered
  first->send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  const auto client = connect();
  ASSERT_TRUE(audited("paired, raw bytes"));
  const Bytes many(1 << 20);
  pollfd space{module.fd(), POLLOUT, 0};
  for (int i = 0; i < 100 && ::poll(&space, 1, 300) > 0; ++i)  // until all buffers are full
    (void)::send(module.fd(), many.data(), many.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  ASSERT_TRUE(audited("no program byte for 1s"));
  server.stop();
  EXPECT_THAT(log.end(), testing::Not(testing::HasSubstr("a client does not disconnect")));
}

}  // namespace
}  // namespace fieldcast::test

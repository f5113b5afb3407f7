#include <gmock/gmock.h>

#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/program/module/relay_end.hpp"
#include "bridge/program/server.hpp"
#include "bridge/security/pki.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/tls_client.hpp"

namespace fieldcast::test {
namespace {

using testing::StartsWith;

struct EngineerAccess : ServerFixture {
  EngineerAccess() {
    files.issue("bridge", "bridge");
    files.issue("anna", "anna");
    files.issue("bob", "bob");
    spec.engineers->tls = {files.file("bridge.pem"), files.file("bridge.key"), files.file("ca.pem"),
                           ""};
  }
  void start(LoginProof proof) {
    spec.engineers->proof = proof;
    ServerFixture::start();
    module = std::make_unique<TcpClient>(this->ServerFixture::module("17\n"));
  }
  [[nodiscard]] std::string answer(const std::string& certificate, const std::string& login = "") {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    std::string reply;
    do {  // registrations and ends of sessions take some time
      SecureClient client(server.engineers_port(),
                          certificate.empty() ? "" : files.file(certificate));
      client.send(login + "@@17FEFF");
      reply = client.receive("FEFF");
    } while ((reply == "@@0001FEFF" || reply == "@@0002FEFF") &&
             std::chrono::steady_clock::now() < deadline);
    return reply;
  }

  Certificates files;
  std::unique_ptr<TcpClient> module;
};

constexpr const char* kPaired = "@@0000FEFF";
constexpr const char* kRefused = "@@0004FEFF";

TEST_F(EngineerAccess, ACertificateOfAProgrammerIsTheLogin) {
  start(LoginProof::kCertificate);
  EXPECT_EQ(answer("anna"), kPaired);
  EXPECT_TRUE(audited("paired"));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(audit.back().who, StartsWith("anna (127.0.0.1:"));
}

TEST_F(EngineerAccess, ACertificateOfSomebodyElseIsNot) {
  files.make_own("forged", "anna");
  start(LoginProof::kCertificate);
  EXPECT_EQ(answer("bob"), kRefused);
  EXPECT_TRUE(audited("login refused: user bob: the role viewer may not program"));
  EXPECT_EQ(answer("forged"), "");
  EXPECT_EQ(answer(""), "");
  EXPECT_EQ(answer("", kLoginOfAnna), "");
  EXPECT_EQ(answer("anna", kLoginOfAnna), kRefused);
  EXPECT_TRUE(audited("here the certificate is the login"));
}

TEST_F(EngineerAccess, ACertificateThatAnEngineerHasSignedIsNotLetIn) {
  files.issue("made-by-bob", "anna", "bob");  // openssl's defaults let bob sign certificates
  start(LoginProof::kCertificate);
  EXPECT_EQ(answer("made-by-bob"), "");
  EXPECT_TRUE(audited("certificate verify failed"));
}

TEST_F(EngineerAccess, ARevokedCertificateIsNotLetIn) {
  const security::Identity authority{files.text("ca.pem"), files.text("ca.key")};
  const UtcTime now = read_clocks().utc;
  const std::string list = security::empty_revocations(authority, now);
  spec.engineers->tls.revoked =
      files.write("revoked.pem", security::revoke(authority, list, files.text("anna.pem"), now));
  start(LoginProof::kCertificate);
  EXPECT_EQ(answer("anna"), "");
  EXPECT_TRUE(audited("certificate verify failed"));
}

TEST_F(EngineerAccess, EitherTakesOneOfTheTwoOfOneUser) {
  spec.engineers->login = LoginRule::kAlways;
  start(LoginProof::kEither);
  EXPECT_EQ(answer(""), kRefused);
  EXPECT_EQ(answer("", kLoginOfAnna), kPaired);
  EXPECT_EQ(answer("anna"), kPaired);
  EXPECT_EQ(answer("anna", kLoginOfBob), kRefused);
  EXPECT_TRUE(audited("the certificate is that of anna"));
}

TEST_F(EngineerAccess, BothAreOfTheSameUser) {
  start(LoginProof::kBoth);
  EXPECT_EQ(answer("anna"), kRefused) << "without a password";
  EXPECT_EQ(answer("", kLoginOfAnna), "") << "without a certificate";
  EXPECT_EQ(answer("bob", kLoginOfAnna), kRefused);
  EXPECT_TRUE(audited("the certificate is that of bob"));
  EXPECT_EQ(answer("anna", kLoginOfAnna), kPaired);
}

}  // namespace
}  // namespace fieldcast::test

namespace fieldcast::program {
namespace {

TEST(AccessText, SaysWhatModulesHaveToShow) {
  ModulesSpec modules;
  modules.listen = {"127.0.0.1", 4951};
  EXPECT_EQ(to_text(modules),
            "modules dial in at 127.0.0.1:4951: every program on this machine can claim to be any "
            "of them; a "
            "second one of a number is refused");
  modules.listen.host = "::";
  modules.without_security = true;
  modules.second = SecondModule::kReplace;
  EXPECT_EQ(to_text(modules),
            "modules dial in at [::]:4951: security: none, every client that reaches the port can "
            "claim to be any of "
            "them; a second one of a number takes the place of the first");
  modules.tls = {"a.pem", "a.key", "plant.pem", "revoked.pem"};
  modules.secrets = "secrets";
  modules.from = {"10.0.0.0/8", "10.1.2.3"};
  EXPECT_EQ(to_text(modules),
            "modules dial in at [::]:4951: TLS with a certificate of plant.pem that is not "
            "revoked, the secret of secrets, from 10.0.0.0/8, 10.1.2.3; a second one of a number "
            "takes the place of the first");
  modules.tls = {"a.pem", "a.key", "", ""};
  EXPECT_THAT(to_text(modules), testing::HasSubstr(":4951: TLS, the secret of secrets"));
}

TEST(AccessText, SaysHowEngineersLogIn) {
  EngineersSpec engineers;
  engineers.listen = {"127.0.0.1", 4950};
  const auto said = [&] {
    return to_text(engineers).substr(
        std::string_view("engineers connect at 127.0.0.1:4950: ").size());
  };
  EXPECT_EQ(said(), "no TLS, no login on the loopback");
  engineers.login = LoginRule::kAlways;
  EXPECT_EQ(said(), "no TLS, a login with the password of a user");
  engineers.tls = {"a.pem", "a.key", "plant.pem", ""};
  engineers.proof = LoginProof::kEither;
  EXPECT_EQ(said(), "TLS, a login with the certificate or the password of a user");
  engineers.proof = LoginProof::kBoth;
  EXPECT_EQ(said(),
            "TLS with a certificate of plant.pem, a login with the certificate and the password of "
            "a user");
  engineers.proof = LoginProof::kCertificate;
  EXPECT_EQ(said(), "TLS with a certificate of plant.pem, the certificate is the login");
}

}  // namespace
}  // namespace fieldcast::program

namespace fieldcast {
namespace {

using program::SilentConnections;

TEST(SilentConnections, OneMoreFromAFullAddressDisplacesItsOldest) {
  std::vector<int> cut;
  const auto cuts = [&](int number) { return [&cut, number] { cut.push_back(number); }; };
  SilentConnections silent(10, 2);
  const auto first = silent.add("a", cuts(1));
  const auto second = silent.add("a", cuts(2));
  (void)silent.add("b", cuts(3));
  (void)silent.add("a", cuts(4));
  EXPECT_THAT(cut, testing::ElementsAre(1));
  EXPECT_FALSE(silent.remove(first));
  EXPECT_TRUE(silent.remove(second));  // it sent data
  (void)silent.add("a", cuts(5));
  EXPECT_THAT(cut, testing::ElementsAre(1));
}

TEST(SilentConnections, WhenAllIsFullTheAddressWithTheMostLosesItsOldest) {
  std::vector<int> cut;
  const auto cuts = [&](int number) { return [&cut, number] { cut.push_back(number); }; };
  SilentConnections silent(4, 3);
  (void)silent.add("engineer", cuts(1));
  for (int i = 2; i <= 4; ++i) (void)silent.add("flood", cuts(i));
  (void)silent.add("other", cuts(5));
  EXPECT_THAT(cut, testing::ElementsAre(2));
  EXPECT_TRUE(silent.cut_one());
  EXPECT_THAT(cut, testing::ElementsAre(2, 3));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(silent.cut_one());
  EXPECT_FALSE(silent.cut_one());
  EXPECT_THAT(cut, testing::ElementsAre(2, 3, 1, 4, 5));  // the oldest among equals
  EXPECT_EQ(silent.size(), 0u);
}

}  // namespace
}  // namespace fieldcast

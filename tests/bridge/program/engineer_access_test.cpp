#include "bridge/base/clock.hpp"
#include "bridge/security/pki.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/tls_client.hpp"

namespace fieldcast {
namespace {

using test::SecureClient;
using test::TcpClient;
using testing::StartsWith;

constexpr const char* kLoginOfAnna = "@@AU616e6e61:736563726574FEFF";  // anna, secret
constexpr const char* kLoginOfBob = "@@AU626f62:736563726574FEFF";

struct EngineerAccess : test::ServerFixture {
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

  test::Certificates files;
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
}  // namespace fieldcast

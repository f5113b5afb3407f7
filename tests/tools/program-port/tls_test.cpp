#include <fstream>

#include "tests/tools/program-port/port_support.hpp"

namespace fieldcast::test {
namespace {

using testing::HasSubstr;

struct Tls : PortFixture {
  Tls() {
    Process openssl(
        "/usr/bin/openssl",
        {"req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
         "-days", "2", "-subj", "/CN=bridge", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout",
         folder / "key.pem", "-out", folder / "cert.pem"});
    EXPECT_EQ(openssl.exit_code(), 0) << openssl.output();
    std::ofstream(folder / "right") << "secret\n";
    std::ofstream(folder / "wrong") << "guess\n";
    for (const char* file : {"right", "wrong"}) {
      std::filesystem::permissions(
          folder / file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    }
    spec.engineers->tls.certificate = folder / "cert.pem";
    spec.engineers->tls.key = folder / "key.pem";
  }
  [[nodiscard]] std::vector<std::string> secure(const std::string& password) const {
    return arguments(
        {"--ca", folder / "cert.pem", "--user", "anna", "--password-file", folder / password});
  }
};

TEST_F(Tls, ARightLoginPairsAndCarriesBytes) {
  start();
  TcpClient module = this->module("17\n");
  // Without plain-text clients there is no query for the registration, so the test retries.
  for (int attempt = 0; attempt < 50; ++attempt) {
    Process port(FIELDCAST_PORT, secure("right"));
    if (port.said("paired").find("17: paired") == std::string::npos) {
      ASSERT_EQ(port.exit_code(), 3) << port.output();
      continue;
    }
    const SerialSoftware software(link);
    software.send("@00x*\r");
    EXPECT_EQ(module.receive("\r"), "@00x*\r");
    module.send("@00y*\r");
    EXPECT_EQ(software.receive(6), "@00y*\r");
    EXPECT_TRUE(audited("paired"));
    return;
  }
  FAIL() << "the module was never there";
}

TEST_F(Tls, AWrongPasswordIsRefused) {
  start();
  Process port(FIELDCAST_PORT, secure("wrong"));
  EXPECT_EQ(port.exit_code(), 3);
  EXPECT_THAT(port.output(), HasSubstr("the login of anna is refused: a wrong password"));
  EXPECT_TRUE(audited("login refused: user anna: wrong password"));
}

TEST_F(Tls, ABridgeThatIsNotTheOneExpectedGetsNoPassword) {
  start();
  Process port(FIELDCAST_PORT,
               arguments({"--tls", "--user", "anna", "--password-file", folder / "right"}));
  EXPECT_EQ(port.exit_code(), 5);
  EXPECT_THAT(port.output(), HasSubstr("certificate verify failed"));
  EXPECT_TRUE(audited("TLS handshake"));
}

TEST_F(Tls, AClientInTheClearIsTurnedAway) {
  start();
  TcpClient client = engineer();
  client.send("@@17FEFF");
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(audited("TLS handshake"));
}

TEST_F(Tls, AClientThatNeverShakesHandsIsHungUpAndAudited) {
  spec.engineers->handshake = std::chrono::milliseconds{100};
  start();
  TcpClient client = engineer();
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(audited("refused: no TLS handshake in time"));
}

TEST_F(Tls, AKeyThatIsNotTheCertificatesIsAnErrorInWords) {
  spec.engineers->tls.key = folder / "right";
  const auto started = server.start(spec);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error(), HasSubstr("no private key"));
}

}  // namespace
}  // namespace fieldcast::test

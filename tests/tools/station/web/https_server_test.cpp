#include "tests/tools/station/web/http_server_fixture.hpp"

namespace fieldcast::web {
namespace {

class HttpsServerTest : public HttpServerTest {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "station-" + std::to_string(::getpid());
    const std::string make =
        "mkdir -p " + folder_ +
        " && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 "
        "-subj /CN=station -addext subjectAltName=IP:127.0.0.1 -keyout " +
        folder_ + "/key.pem -out " + folder_ + "/cert.pem >/dev/null 2>&1";
    ASSERT_EQ(std::system(make.c_str()), 0);
    StationLimits limits;
    limits.handshake = 300ms;
    limits.handshakes = {.total = 3, .of_one = 3, .reserved = 0};
    auto tls = TlsServer::make({folder_ + "/cert.pem", folder_ + "/key.pem", {}, {}});
    ASSERT_TRUE(tls) << tls.error();
    restart(limits, *std::move(tls));
  }
  void TearDown() override { ASSERT_EQ(std::system(("rm -rf " + folder_).c_str()), 0); }
  std::string get(const std::string& path, const std::string& options) {
    const std::string command = "curl -sS --max-time 5 -w '%{http_code}' " + options +
                                " https://127.0.0.1:" + std::to_string(port_) + path + " 2>&1";
    FILE* pipe = ::popen(command.c_str(), "r");
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    ::pclose(pipe);
    return text;
  }
  std::string folder_;
};

TEST_F(HttpsServerTest, TlsOfThePresentIsSpokenAndNothingOlder) {
  EXPECT_EQ(get("/healthz", "--cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_EQ(get("/healthz", "--tls-max 1.2 --cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_THAT(get("/healthz", "--tls-max 1.1 --tlsv1.0 --cacert " + folder_ + "/cert.pem"),
              HasSubstr("000"));
}

TEST_F(HttpsServerTest, OnlyEcdheWithAeadAndTls13AreSpoken) {
  const auto spoken = [this](const std::string& options) {
    const std::string command = "openssl s_client -connect 127.0.0.1:" + std::to_string(port_) +
                                " " + options + " </dev/null 2>&1";
    FILE* pipe = ::popen(command.c_str(), "r");
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    ::pclose(pipe);
    return text;
  };
  for (const std::string suite : {"ECDHE-ECDSA-AES128-GCM-SHA256", "ECDHE-ECDSA-AES256-GCM-SHA384",
                                  "ECDHE-ECDSA-CHACHA20-POLY1305"})
    EXPECT_THAT(spoken("-tls1_2 -cipher " + suite), HasSubstr("Cipher is " + suite));
  EXPECT_THAT(spoken("-tls1_3"), HasSubstr("New, TLSv1.3, Cipher is TLS_"));
  // The alert shows that the server refuses, not the client.
  for (const std::string suite :
       {"ECDHE-ECDSA-AES128-SHA", "ECDHE-ECDSA-AES128-SHA256", "ECDHE-ECDSA-AES128-CCM",
        "AES128-GCM-SHA256", "AES128-SHA", "DHE-RSA-AES128-GCM-SHA256"})
    EXPECT_THAT(spoken("-tls1_2 -cipher " + suite + "@SECLEVEL=0"), HasSubstr("alert handshake"))
        << suite;
  for (const std::string version : {"-tls1", "-tls1_1"})
    EXPECT_THAT(spoken(version + " -cipher DEFAULT@SECLEVEL=0"),
                HasSubstr("alert protocol version"))
        << version;
}

TEST_F(HttpsServerTest, GarbageInsteadOfAHandshakeEndsTheConnectionOnly) {
  for (const std::string& bytes :
       {std::string("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"), std::string(3000, '\xff'),
        std::string("\x16\x03\x01\xff\xff\x01\xff\xff\xff", 9) + std::string(5000, 'x'),
        std::string(20'000, '\0')}) {
    RawClient client(port_);
    client.send(bytes);
    EXPECT_TRUE(client.ends());
  }
  EXPECT_EQ(get("/healthz", "--cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_EQ(counters().faults, 4u);
}

TEST_F(HttpsServerTest, HandshakesThatNeverEndAreCutByTimeAndNumber) {
  std::vector<RawClient> clients;
  for (int i = 0; i < 5; ++i) clients.emplace_back(port_);
  for (RawClient& client : clients) EXPECT_TRUE(client.ends());
  EXPECT_EQ(counters().turned_away, 2u);
  for (int i = 0; i < 100 && counters().open > 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(counters().open, 0u);
}

TEST_F(HttpsServerTest, HandshakesOfARenewedCertificateAreNotCounted) {
  std::vector<RawClient> clients;
  for (int i = 0; i < 3; ++i) clients.emplace_back(port_);
  for (int i = 0; i < 100 && counters().open < 3; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(counters().open, 3u);
  auto tls = TlsServer::make({folder_ + "/cert.pem", folder_ + "/key.pem", {}, {}});
  ASSERT_TRUE(tls) << tls.error();
  run([&] { server_->http().serve(*std::move(tls)); });
  EXPECT_EQ(counters().open, 0u);
  EXPECT_EQ(get("/healthz", "--cacert " + folder_ + "/cert.pem"), "ok\n200");
  EXPECT_EQ(counters().turned_away, 0u);
}

}  // namespace
}  // namespace fieldcast::web

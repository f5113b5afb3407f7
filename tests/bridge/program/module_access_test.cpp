#include "bridge/base/clock.hpp"
#include "bridge/program/module/module_gate.hpp"
#include "bridge/security/pki.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/tls_client.hpp"

namespace fieldcast::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kSecret = "a secret of twenty-six let";

struct ModuleAccess : ServerFixture {
  void expect_programmable(const std::string& number, auto& module) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    std::unique_ptr<TcpClient> client;
    std::string reply;
    do {  // the earlier one may still be closing
      reply = paired(server.engineers_port(), number, client);
    } while (reply == "@@0002FEFF" && std::chrono::steady_clock::now() < deadline);
    ASSERT_EQ(reply, "@@0000FEFF");
    client->send("@@@00x*\rFEFF");
    EXPECT_EQ(module.receive("\r"), "@00x*\r");
    module.send("@00y*\r");
    EXPECT_EQ(client->receive("\rFEFF"), "@@@00y*\rFEFF");
  }
  [[nodiscard]] static std::string challenge_of(auto& module) {
    std::string line = module.receive("\r\n");
    EXPECT_THAT(line, StartsWith("challenge "));
    return line.size() < 12 ? "" : line.substr(10, line.size() - 12);
  }

  Certificates files;
};

struct ModuleTls : ModuleAccess {
  ModuleTls() {
    files.issue("bridge", "bridge");
    files.issue("17", "17");
    spec.modules->tls = {files.file("bridge.pem"), files.file("bridge.key"), files.file("ca.pem"),
                         ""};
  }
  [[nodiscard]] SecureClient secure(const std::string& name, const std::string& text) const {
    SecureClient made(server.modules_port(), name.empty() ? "" : files.file(name));
    made.send(text);
    return made;
  }
};

TEST_F(ModuleTls, AModuleReportsTheNumberOfItsCertificate) {
  start();
  SecureClient module = secure("17", "17\n");
  expect_programmable("17", module);
}

TEST_F(ModuleTls, AModuleWithoutACertificateOrWithOneOfAnotherAuthorityIsNotLetIn) {
  files.make_own("forged", "17");
  start();
  EXPECT_TRUE(secure("", "17\n").is_closed());
  EXPECT_TRUE(audited("did not return a certificate"));
  EXPECT_TRUE(secure("forged", "17\n").is_closed());
  EXPECT_TRUE(audited("certificate verify failed"));
  TcpClient plain = this->module("ID=17 in the clear\n");
  EXPECT_TRUE(plain.is_closed());
  TcpClient client = engineer();
  client.send("@@17FEFF");
  EXPECT_EQ(client.receive("FEFF"), "@@0001FEFF");
}

TEST_F(ModuleTls, AModuleWithAnotherNumberThanItsCertificatesIsNotified) {
  files.issue("gateway", "gateway");
  spec.modules->subjects = {{"gateway", {"18", "19"}}};
  start();
  SecureClient liar = secure("17", "18\n");
  EXPECT_EQ(liar.receive("\r\n"), "refused: the certificate of '17' is none for module 18\r\n");
  EXPECT_TRUE(liar.is_closed());
  EXPECT_TRUE(audited("module turned away: the certificate of '17' is none for module 18"));
  SecureClient outside = secure("gateway", "17\n");
  EXPECT_THAT(outside.receive("\r\n"), StartsWith("refused: the certificate of 'gateway'"));
  SecureClient listed = secure("gateway", "19\n");
  expect_programmable("19", listed);
}

TEST_F(ModuleTls, ACertificateThatIsRevokedWhileTheBridgeRunsIsNotLetInAnyMore) {
  const security::Identity authority{files.text("ca.pem"), files.text("ca.key")};
  const UtcTime now = read_clocks().utc;
  const std::string empty = security::empty_revocations(authority, now);
  spec.modules->tls.revoked = files.write("revoked.pem", empty);
  spec.modules->second = SecondModule::kReplace;
  start();
  SecureClient before = secure("17", "17\n");
  expect_programmable("17", before);
  files.write("revoked.pem", security::revoke(authority, empty, files.text("17.pem"), now));
  EXPECT_TRUE(secure("17", "17\n").is_closed());
  EXPECT_TRUE(audited("certificate verify failed"));
  files.write("revoked.pem", "half a list");
  EXPECT_TRUE(secure("17", "17\n").is_closed());
  EXPECT_TRUE(audited("revoked.pem: no list of revoked certificates"));
}

TEST_F(ModuleTls, AFileThatIsOfNoUseIsAnErrorThatNamesIt) {
  files.write("open.key", files.text("bridge.key"), 0644);
  const auto error_with = [&](std::string TlsSpec::*file, const std::string& path) {
    ProgramSpec wrong = spec;
    wrong.modules->tls.*file = path;
    const auto started = server.start(wrong);
    return started ? "" : started.error();
  };
  EXPECT_THAT(error_with(&TlsSpec::key, files.file("open.key")), HasSubstr("others may read"));
  EXPECT_THAT(error_with(&TlsSpec::key, files.file("17.key")), HasSubstr("17.key"));
  EXPECT_THAT(error_with(&TlsSpec::authority, files.file("17.key")), HasSubstr("17.key"));
  EXPECT_THAT(error_with(&TlsSpec::revoked, files.file("ca.pem")), HasSubstr("ca.pem"));
}

struct ModuleSecret : ModuleAccess {
  ModuleSecret() {
    spec.modules->registration.prefix = "ID=";
    spec.modules->secrets = files.write(
        "secrets", std::string("# of the huts\n17 ") + kSecret + "\n* another secret of all\n");
  }
};

TEST_F(ModuleSecret, AModuleThatKnowsItsSecretIsLetIn) {
  start();
  TcpClient module = this->module("");
  const std::string challenge = challenge_of(module);
  module.send("ID=17 " + program::response_to(challenge, "17", Secret(kSecret)) + "\r\n");
  expect_programmable("17", module);
}

TEST_F(ModuleSecret, AModuleWithoutItIsNotifiedAndTheSecretIsNowhere) {
  start();
  testing::internal::CaptureStderr();
  const std::string right = std::string(64, '0');
  for (const std::string& answer :
       {std::string("ID=17"), std::string("ID=17 ") + kSecret, "ID=17 " + right}) {
    TcpClient module = this->module("");
    (void)challenge_of(module);
    module.send(answer + "\r\n");
    EXPECT_THAT(module.receive("\r\n"), StartsWith("refused: module 17 does not "));
    EXPECT_TRUE(module.is_closed());
  }
  EXPECT_TRUE(audited("module 17 does not respond to the challenge"));
  EXPECT_TRUE(audited("module 17 does not know its secret"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::Not(HasSubstr(kSecret)));
  const std::lock_guard lock(mutex);
  for (const auto& entry : audit) EXPECT_THAT(entry.result, testing::Not(HasSubstr(kSecret)));
}

TEST_F(ModuleSecret, AResponseIsGoodForOneChallengeAndOneNumber) {
  start();
  TcpClient first = this->module("");
  const std::string challenge = challenge_of(first);
  const std::string answer = program::response_to(challenge, "17", Secret(kSecret));
  TcpClient again = this->module("");
  EXPECT_NE(challenge_of(again), challenge);
  again.send("ID=17 " + answer + "\r\n");
  EXPECT_EQ(again.receive("\r\n"), "refused: module 17 does not know its secret\r\n");
  first.send("ID=18 " + answer + "\r\n");
  EXPECT_EQ(first.receive("\r\n"), "refused: module 18 does not know its secret\r\n");
}

TEST_F(ModuleSecret, ASecretOfAllIsForNumbersWithoutOneOfTheirOwn) {
  start();
  const Secret all("another secret of all");
  TcpClient own = this->module(""), other = this->module("");
  own.send("ID=17 " + program::response_to(challenge_of(own), "17", all) + "\r\n");
  EXPECT_THAT(own.receive("\r\n"), StartsWith("refused"));
  other.send("ID=18 " + program::response_to(challenge_of(other), "18", all) + "\r\n");
  expect_programmable("18", other);
}

TEST_F(ModuleSecret, ASecretThatChangesHoldsForTheNextModule) {
  start();
  const auto answered = [this](std::string_view secret) {
    TcpClient module = this->module("");
    module.send("ID=17 " + program::response_to(challenge_of(module), "17", Secret(secret)) +
                "\r\n");
    return module.receive("\r\n", std::chrono::milliseconds{200});
  };
  files.write("secrets", "17 a new secret of the hut\n");
  EXPECT_EQ(answered(kSecret), "refused: module 17 does not know its secret\r\n");
  EXPECT_EQ(answered("a new secret of the hut"), "");
  files.write("secrets", "17 short\n");
  EXPECT_EQ(answered("a new secret of the hut"), "refused: module 17 does not know its secret\r\n");
}

TEST_F(ModuleSecret, TheResponseIsTheOneOfTheDocument) {
  // printf 'fieldcast module 17 abc' | openssl dgst -sha256 -hmac 'a secret of twenty-six let'
  EXPECT_EQ(program::response_to("abc", "17", Secret(kSecret)),
            "df89db7b9a7c20adb50053f8988a45494c3036a86ba1326f302ad1ddfdb977fb");
}

TEST_F(ModuleSecret, AFileOfSecretsIsRefusedWithoutAWordOfIt) {
  const auto error_of = [&](const std::string& content, unsigned mode = 0600) {
    spec.modules->secrets = files.write("wrong", content, mode);
    const auto started = server.start(spec);
    return started ? "" : started.error();
  };
  EXPECT_THAT(error_of("17 " + std::string(kSecret), 0604), HasSubstr("others may read"));
  EXPECT_THAT(error_of("root:$6$hash:19000\n"), HasSubstr("wrong:1: this is no line of secrets"));
  EXPECT_THAT(error_of("17 short\n"), HasSubstr("at least 16"));
  EXPECT_THAT(error_of("# none\n"), HasSubstr("no secret"));
  EXPECT_THAT(error_of("root:$6$hash:19000\n"), testing::Not(HasSubstr("hash")));
}

TEST_F(ModuleAccess, AModuleFromElsewhereIsNotHeard) {
  spec.modules->from = {"127.0.0.7", "10.0.0.0/8"};
  start();
  TcpClient far = this->module("17\n");
  EXPECT_TRUE(far.is_closed());
  EXPECT_TRUE(audited("no module dials in from there"));
  TcpClient listed(server.modules_port(), "127.0.0.7");
  listed.send("17\n");
  expect_programmable("17", listed);
}

TEST_F(ModuleAccess, ASecondModuleOfANumberIsRefusedWithAReason) {
  start();
  TcpClient first = this->module("17\n");
  expect_programmable("17", first);
  TcpClient second = this->module("17\n");
  EXPECT_THAT(second.receive("\r\n"), StartsWith("refused: module 17 is connected already"));
  EXPECT_TRUE(second.is_closed());
  EXPECT_TRUE(audited("module turned away: module 17 is connected already"));
  expect_programmable("17", first);
  first.close();
  TcpClient third = this->module("17\n");
  expect_programmable("17", third);
}

}  // namespace
}  // namespace fieldcast::test

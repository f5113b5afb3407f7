#include <gmock/gmock.h>

#include "bridge/program/server.hpp"

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

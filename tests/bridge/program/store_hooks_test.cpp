#include "bridge/program/store_hooks.hpp"

#include <gmock/gmock.h>

namespace fieldcast::program {
namespace {

using testing::HasSubstr;

struct FakeStore : Audit, Logins {
  void append(AuditEntry entry) override { entries.push_back(std::move(entry)); }
  void authenticate(LoginAttempt attempt, std::function<void(LoginResult)> done) override {
    attempts.push_back(attempt);
    done(answer);
  }
  std::vector<AuditEntry> entries;
  std::vector<LoginAttempt> attempts;
  LoginResult answer = Role::kProgrammer;
};

struct StoreHooks : testing::Test {
  StoreHooks() { join_store(hooks, doors); }
  void open() { doors = {&store, &store}; }
  LoginAnswer login() {
    LoginAnswer answer{true, "never answered"};
    hooks.login("anna", "secret", "10.0.0.7", [&](const LoginAnswer& given) { answer = given; });
    return answer;
  }
  FakeStore store;
  StoreDoors doors;
  Hooks hooks;
};

TEST_F(StoreHooks, OnlyAProgrammerMayLogIn) {
  open();
  EXPECT_TRUE(login().allowed);
  EXPECT_EQ(store.attempts[0].user + store.attempts[0].password + store.attempts[0].peer, "annasecret10.0.0.7");
  for (const Role role : {Role::kViewer, Role::kOperator}) {
    store.answer = role;
    const LoginAnswer answer = login();
    EXPECT_FALSE(answer.allowed);
    EXPECT_THAT(answer.reason, HasSubstr(std::string(to_text(role)) + ", not programmer"));
  }
}

TEST_F(StoreHooks, ARefusalSaysWhy) {
  open();
  store.answer = tl::make_unexpected(LoginRefused{LoginRefused::Why::kTooSoon, std::chrono::seconds{4}});
  const LoginAnswer answer = login();
  EXPECT_FALSE(answer.allowed);
  EXPECT_EQ(answer.reason, to_text(LoginRefused{LoginRefused::Why::kTooSoon, std::chrono::seconds{4}}));
}

TEST_F(StoreHooks, WithoutAStoreNobodyLogsInAndNothingIsKept) {
  EXPECT_FALSE(login().allowed);
  hooks.audit({"anna", "line/plc", 1, 2, "ended"});
  EXPECT_TRUE(store.entries.empty());
}

TEST_F(StoreHooks, EveryTransmissionIsAudited) {
  open();
  hooks.audit({"anna (10.0.0.7:5)", "line/plc", 1, 2, "ended: stopped by the engineer"});
  ASSERT_EQ(store.entries.size(), 1u);
  EXPECT_EQ(store.entries[0],
            (AuditEntry{{}, "anna (10.0.0.7:5)", "program", "line/plc", 1, 2, "ended: stopped by the engineer"}));
}

}  // namespace
}  // namespace fieldcast::program

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <future>
#include <sstream>

#include "bridge/store/users/authenticator.hpp"
#include "bridge/store/users/user_table.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast::test {
namespace {

using testing::HasSubstr;
using testing::Not;

const UtcTime kNow{1'700'000'000'000'000'000};

class Users : public testing::Test {
 protected:
  Users() { (void)table_.add("ann", Role::kProgrammer, "correct horse", kNow); }

  LoginResult ask(Authenticator& authenticator, const std::string& user,
                  const std::string& password, const std::string& peer = "10.0.0.1") {
    std::promise<LoginResult> answered;
    auto answer = answered.get_future();
    authenticator.authenticate({user, Secret(password), peer},
                               [&](LoginResult result) { answered.set_value(result); });
    if (answer.wait_for(std::chrono::seconds{30}) != std::future_status::ready) {
      ADD_FAILURE() << "no response in 30 s";
      std::abort();
    }
    return answer.get();
  }

  Scratch scratch_;
  StoreAddress address_{scratch_.path("store.db")};
  std::unique_ptr<SqlConnection> connection_ = open_store(address_, IfMissing::kCreate);
  UserTable table_{*connection_};
  RecordingAudit audit_;
};

TEST_F(Users, AreListedByNameWithTheirRole) {
  EXPECT_TRUE(table_.add("bob", Role::kViewer, "another password", kNow));
  const auto users = table_.list();
  ASSERT_EQ(users.size(), 2u);
  EXPECT_EQ(users[0].name, "ann");
  EXPECT_EQ(users[0].role, Role::kProgrammer);
  EXPECT_EQ(users[1].name, "bob");
  EXPECT_EQ(users[1].role, Role::kViewer);
  EXPECT_EQ(users[1].created_at, kNow);
}

TEST_F(Users, AreAddedOnceAndRemovedOnce) {
  EXPECT_FALSE(table_.add("ann", Role::kViewer, "other password", kNow));
  const auto verified = table_.verify("ann", "correct horse");
  ASSERT_TRUE(verified);
  EXPECT_EQ(verified->role, Role::kProgrammer);
  EXPECT_TRUE(table_.remove("ann"));
  EXPECT_FALSE(table_.remove("ann"));
  EXPECT_FALSE(table_.verify("ann", "correct horse"));
}

TEST_F(Users, AreKeptWithoutTheirPasswords) {
  connection_.reset();  // the last connection to close writes all data into the file
  std::ifstream file(address_.text(), std::ios::binary);
  std::stringstream content;
  content << file.rdbuf();
  EXPECT_THAT(content.str(), HasSubstr("$argon2id$"));
  EXPECT_THAT(content.str(), Not(HasSubstr("correct horse")));
}

TEST_F(Users, AreReadableByTheOwnerOfTheFileOnly) {
  for (const char* suffix : {"", "-wal"}) {
    struct stat info {};
    ASSERT_EQ(::stat((address_.text() + suffix).c_str(), &info), 0) << suffix;
    EXPECT_EQ(info.st_mode & 0777, 0600u) << suffix;
  }
}

TEST_F(Users, HaveNamesThatCanStandInALine) {
  EXPECT_EQ(fault_of_user_name("ann.smith@plant-7_b"), "");
  for (const std::string& bad :
       std::vector<std::string>{"", "two words", "a\nb", "\x01", "ü", std::string(65, 'a')}) {
    EXPECT_NE(fault_of_user_name(bad), "") << bad;
  }
  EXPECT_NE(fault_of_password("short"), "");
  EXPECT_NE(fault_of_password(std::string(Logins::kMaxPasswordBytes + 1, 'x')), "");
  EXPECT_EQ(fault_of_password("long enough"), "");
}

TEST_F(Users, LogInWithTheirPasswordAndGetTheirRole) {
  Authenticator authenticator(address_, audit_);
  const auto result = ask(authenticator, "ann", "correct horse");
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->name, "ann");
  EXPECT_EQ(result->role, Role::kProgrammer);
  EXPECT_EQ(result->created_at, kNow);
  ASSERT_EQ(audit_.entries().size(), 1u);
  EXPECT_EQ(audit_.entries()[0].who, "ann from 10.0.0.1");
  EXPECT_EQ(audit_.entries()[0].what, "login");
  EXPECT_EQ(audit_.entries()[0].result, "done");
}

TEST_F(Users, WrongPasswordsAndUnknownUsersGetTheSameResponseSlowedDownAndAudited) {
  Authenticator authenticator(address_, audit_);
  EXPECT_EQ(ask(authenticator, "ann", "wrong").error().why, LoginRefused::Why::kWrong);
  EXPECT_EQ(ask(authenticator, "eve", "correct horse").error().why, LoginRefused::Why::kWrong);
  EXPECT_EQ(to_text(ask(authenticator, "ann", "").error()),
            to_text(ask(authenticator, "eve", "x").error()));
  EXPECT_EQ(ask(authenticator, "ann", "wrong").error().why, LoginRefused::Why::kWrong);
  const auto slowed = ask(authenticator, "ann", "correct horse");
  ASSERT_FALSE(slowed.has_value());
  EXPECT_EQ(slowed.error().why, LoginRefused::Why::kTooSoon);
  EXPECT_GT(slowed.error().wait, Duration{});
  const auto entries = audit_.entries();
  ASSERT_EQ(entries.size(), 6u);
  EXPECT_EQ(entries[0].result, "refused: wrong user or password");
  EXPECT_THAT(entries[5].result, HasSubstr("try again in 1s"));
}

// Regression: attempts that cost their sender nothing displaced all other entries.
TEST_F(Users, OfAttemptsWithoutACheckTheFirstIsAudited) {
  Authenticator authenticator(address_, audit_);
  for (int i = 0; i < 3; ++i) (void)ask(authenticator, "two words", "x");
  EXPECT_EQ(audit_.entries().size(), 1u);
  for (const std::string user : {"ann", "eve"}) {
    const std::size_t before = audit_.entries().size();
    for (unsigned i = 0; i < LoginThrottle::kFreeOfUser; ++i)
      EXPECT_EQ(ask(authenticator, user, "wrong").error().why, LoginRefused::Why::kWrong);
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(ask(authenticator, user, "wrong").error().why, LoginRefused::Why::kTooSoon);
    EXPECT_EQ(audit_.entries().size() - before, LoginThrottle::kFreeOfUser + 1) << user;
    EXPECT_THAT(audit_.entries().back().result, HasSubstr("try again in 1s"));
  }
}

// Regression: a host that changed its IPv6 address was neither slowed down nor summarized.
TEST_F(Users, GuessesFromTheAddressesOfASlash64AreThoseOfOneHost) {
  Authenticator authenticator(address_, audit_);
  const auto guess = [&](unsigned host) {
    return ask(authenticator, "ann", "wrong", "[2001:db8::" + std::to_string(host) + "]");
  };
  for (unsigned i = 0; i < LoginThrottle::kFreeOfUser; ++i)
    EXPECT_EQ(guess(i).error().why, LoginRefused::Why::kWrong);
  for (unsigned i = 10; i < 15; ++i) EXPECT_EQ(guess(i).error().why, LoginRefused::Why::kTooSoon);
  const auto entries = audit_.entries();
  ASSERT_EQ(entries.size(), LoginThrottle::kFreeOfUser + 1);
  EXPECT_EQ(entries.back().who, "ann from [2001:db8::10]") << "the audit has the whole address";
}

TEST_F(Users, GuessesThatAreSentTogetherAreSlowedDownToo) {
  Authenticator authenticator(address_, audit_);
  std::vector<std::future<LoginResult>> answers;
  for (int i = 0; i < 10; ++i) {
    auto answered = std::make_shared<std::promise<LoginResult>>();
    answers.push_back(answered->get_future());
    authenticator.authenticate({"ann", Secret("guess" + std::to_string(i)), "10.0.0.1"},
                               [answered](LoginResult result) { answered->set_value(result); });
  }
  unsigned looked_at = 0;
  for (auto& answer : answers) looked_at += answer.get().error().why == LoginRefused::Why::kWrong;
  EXPECT_LE(looked_at, LoginThrottle::kFreeOfUser);
}

TEST_F(Users, WhatComesFromTheNetworkIsHarmlessInTheAudit) {
  Authenticator authenticator(address_, audit_);
  EXPECT_EQ(ask(authenticator, "a\n2024 fake line" + std::string(5000, 'x'), "p").error().why,
            LoginRefused::Why::kWrong);
  EXPECT_EQ(ask(authenticator, "ann", std::string(1 << 20, 'p')).error().why,
            LoginRefused::Why::kWrong);
  EXPECT_THAT(audit_.entries()[0].who, Not(HasSubstr("\n")));
  EXPECT_LT(audit_.entries()[0].who.size(), 200u);
}

TEST_F(Users, AStoreThatIsNotThereRefusesEverybody) {
  Authenticator authenticator(StoreAddress{scratch_.path("absent/store.db")}, audit_);
  EXPECT_EQ(ask(authenticator, "ann", "correct horse").error().why,
            LoginRefused::Why::kUnavailable);
}

TEST_F(Users, WhoStillWaitsWhenTheRouterClosesIsNotified) {
  std::atomic<unsigned> answered{0};
  {
    Authenticator authenticator(address_, audit_);
    for (int i = 0; i < 5; ++i)
      authenticator.authenticate({"ann", Secret("correct horse"), "10.0.0.1"},
                                 [&](const LoginResult&) { ++answered; });
  }
  EXPECT_EQ(answered, 5u);
}

}  // namespace
}  // namespace fieldcast::test

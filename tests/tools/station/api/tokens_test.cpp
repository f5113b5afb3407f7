#include <future>

#include "bridge/store/users/user_table.hpp"
#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/administration.hpp"

namespace fieldcast::web {
namespace {

using namespace std::chrono_literals;
using test::utc;

class TokensTest : public test::ApiTest {
 protected:
  TokensTest() {
    const auto connection = open_store(address(), IfMissing::kCreate);
    EXPECT_TRUE(TokenTable(*connection).add({"wall", utc(0), utc(kNow + 60)}, secret_));
    EXPECT_TRUE(TokenTable(*connection).add({"old", utc(0), utc(kNow - 1)}, ended_));
  }
  [[nodiscard]] LoginVerdict check(const std::string& token, const std::string& peer = "10.0.0.1") {
    std::optional<LoginVerdict> verdict;
    tokens_.check(token, peer, [&](LoginVerdict given) { verdict = std::move(given); });
    EXPECT_TRUE(io_.run_until([&] { return verdict.has_value(); }));
    return verdict.value_or(LoginGrant{});
  }
  [[nodiscard]] LoginRefused::Why why(const std::string& token) {
    const LoginVerdict verdict = check(token);
    EXPECT_FALSE(verdict);
    return verdict ? LoginRefused::Why::kUnavailable : verdict.error().why;
  }

  const std::string secret_ = make_token();
  const std::string ended_ = make_token();
  fieldcast::test::RecordingAudit audit_;
  Instant steady_{1h};
  Tokens tokens_{*database(), audit_, now(), [this] { return steady_; }};
};

TEST_F(TokensTest, ATokenLetsReadUntilItsEnd) {
  const LoginVerdict verdict = check(secret_);
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->user, "wall");
  EXPECT_EQ(verdict->role, Role::kViewer);
  EXPECT_EQ(verdict->left, 60s);
  EXPECT_TRUE(verdict->by_token);
  EXPECT_EQ(verdict->credential_created_at, utc(0));
}

TEST_F(TokensTest, OneThatHasEndedOrIsNobodysIsRefusedAlike) {
  EXPECT_EQ(why(ended_), LoginRefused::Why::kWrong);
  EXPECT_EQ(why(make_token()), LoginRefused::Why::kWrong);
  EXPECT_EQ(why("nonsense"), LoginRefused::Why::kWrong);
}

TEST_F(TokensTest, WhoSendsWrongOnesHasToWait) {
  for (unsigned i = 0; i <= LoginThrottle::kFreeOfUser; ++i) (void)check(make_token());
  EXPECT_EQ(why(secret_), LoginRefused::Why::kTooSoon);
  EXPECT_TRUE(check(secret_, "10.0.0.2")) << "others need not";
  steady_ += 10min;
  EXPECT_TRUE(check(secret_));
}

// Regression: a host that changed its IPv6 address had no wait.
TEST_F(TokensTest, TheAddressesOfASlash64AreOneSender) {
  for (unsigned i = 0; i < LoginThrottle::kFreeOfUser; ++i)
    (void)check(make_token(), "[2001:db8::" + std::to_string(i) + "]");
  for (const char* peer : {"[2001:db8::10]", "[2001:db8::11]"}) {
    const LoginVerdict verdict = check(secret_, peer);
    ASSERT_FALSE(verdict);
    EXPECT_EQ(verdict.error().why, LoginRefused::Why::kTooSoon);
  }
  EXPECT_EQ(audit_.entries().size(), LoginThrottle::kFreeOfUser + 1);
  EXPECT_TRUE(check(secret_, "[2001:db8:0:1::1]"));
}

TEST_F(TokensTest, EveryAttemptIsAuditedWithoutTheToken) {
  (void)check(secret_);
  (void)check(ended_);
  (void)check("nonsense");
  const auto entries = audit_.entries();
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0].who, "token wall from 10.0.0.1");
  EXPECT_EQ(entries[0].what, "login");
  EXPECT_EQ(entries[0].result, "done");
  EXPECT_EQ(entries[1].who, "a token from 10.0.0.1");
  for (const AuditEntry& entry : entries) {
    for (const std::string& text : {entry.who, entry.target, entry.result}) {
      EXPECT_EQ(text.find("fct_"), std::string::npos);
      EXPECT_EQ(text.find("nonsense"), std::string::npos);
    }
  }
}

// Regression: each attempt of a peer that had to wait was audited.
TEST_F(TokensTest, TheFirstAttemptOfEachWaitIsAudited) {
  for (unsigned i = 0; i < LoginThrottle::kFreeOfUser; ++i) (void)check(make_token());
  for (unsigned wait = 1; wait <= 2; ++wait) {
    for (int i = 0; i < 9; ++i) EXPECT_EQ(why(secret_), LoginRefused::Why::kTooSoon);
    EXPECT_EQ(audit_.entries().size(), LoginThrottle::kFreeOfUser + 2 * wait - 1) << wait;
    steady_ += 10s;
    EXPECT_EQ(why("nonsense"), LoginRefused::Why::kWrong);
  }
}

TEST_F(TokensTest, TheListHasThoseThatHaveNotExpired) {
  std::optional<std::optional<std::vector<Token>>> valid;
  tokens_.list([&](auto given) { valid = std::move(given); });
  ASSERT_TRUE(io_.run_until([&] { return valid.has_value(); }));
  ASSERT_TRUE(*valid);
  EXPECT_EQ(**valid, (std::vector<Token>{{"wall", utc(0), utc(kNow + 60)}}));
}

TEST_F(TokensTest, TheListIsReadAlsoIfTheDatabaseIsBusy) {
  std::promise<void> end;
  std::size_t responses = 0;
  const auto done = [&](const tl::expected<int, DatabaseFault>&) { ++responses; };
  const std::shared_future<void> ended = end.get_future().share();
  for (std::size_t i = 0; i <= Database::kMaxWaiting; ++i)
    database()->query<int>([ended](SqlConnection&) { return ended.wait(), 0; }, done);
  std::optional<std::optional<std::vector<Token>>> valid;
  tokens_.list([&](auto given) { valid = std::move(given); });
  end.set_value();
  ASSERT_TRUE(io_.run_until([&] { return valid && responses > Database::kMaxWaiting; }));
  EXPECT_TRUE(*valid);
  EXPECT_EQ(database()->counters().busy, 1u);
}

}  // namespace
}  // namespace fieldcast::web

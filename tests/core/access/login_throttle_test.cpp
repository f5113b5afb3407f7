#include <gtest/gtest.h>

#include "core/access/login.hpp"

namespace fieldcast {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const Instant kStart{std::chrono::hours{1}};

void fail(LoginThrottle& throttle, unsigned times, const std::string& user = "ann",
          const std::string& peer = "10.0.0.1") {
  for (unsigned i = 0; i < times; ++i) throttle.failed(user, peer, kStart);
}

TEST(LoginThrottle, LetsTheFirstAttemptsComeAtOnce) {
  LoginThrottle throttle;
  fail(throttle, LoginThrottle::kFreeOfUser - 1);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart), Duration{});
}

TEST(LoginThrottle, DoublesTheWaitWithEveryFurtherFailureUpToItsLimit) {
  LoginThrottle throttle;
  fail(throttle, LoginThrottle::kFreeOfUser);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart), seconds{1});
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart + seconds{1}), Duration{});
  fail(throttle, 1);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart), seconds{2});
  fail(throttle, 100);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart), LoginThrottle::kLongest);
}

TEST(LoginThrottle, DoesNotLockAUserOutWhoLogsInFromElsewhere) {
  LoginThrottle throttle;
  fail(throttle, 5, "ann", "10.0.0.66");
  EXPECT_GT(throttle.wait("ann", "10.0.0.66", kStart), Duration{});
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart), Duration{});
}

TEST(LoginThrottle, SlowsAPeerDownThatTriesManyUsers) {
  LoginThrottle throttle;
  for (unsigned i = 0; i < LoginThrottle::kFreeOfPeer; ++i)
    fail(throttle, 1, "user" + std::to_string(i));
  EXPECT_EQ(throttle.wait("another", "10.0.0.1", kStart), seconds{1});
  EXPECT_EQ(throttle.wait("another", "10.0.0.2", kStart), Duration{});
}

TEST(LoginThrottle, ForgivesTheUserWhoSucceedsButNotThePeer) {
  LoginThrottle throttle;
  fail(throttle, LoginThrottle::kFreeOfPeer - 1);
  throttle.succeeded("ann", "10.0.0.1");
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", kStart), Duration{});
  fail(throttle, 1);
  EXPECT_EQ(throttle.wait("bob", "10.0.0.1", kStart), seconds{1});
}

TEST(LoginThrottle, ForgetsAfterAQuietTime) {
  LoginThrottle throttle;
  fail(throttle, 50);
  const Instant later = kStart + LoginThrottle::kForget;
  throttle.failed("ann", "10.0.0.1", later);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", later), Duration{});
}

TEST(LoginThrottle, HoldsABoundedNumberOfKeysAndKeepsTheNewest) {
  LoginThrottle throttle;
  for (std::size_t i = 0; i < 2 * LoginThrottle::kMaxKeys; ++i) {
    throttle.failed("u", std::to_string(i), kStart + seconds{i});
  }
  const Instant now = kStart + seconds{2 * LoginThrottle::kMaxKeys};
  for (int i = 0; i < 3; ++i) throttle.failed("ann", "10.0.0.1", now);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.1", now), seconds{1});
}

TEST(Role, EachMayWhatTheOnesBeforeItMay) {
  EXPECT_TRUE(may(Role::kProgrammer, Role::kOperator));
  EXPECT_TRUE(may(Role::kOperator, Role::kOperator));
  EXPECT_FALSE(may(Role::kOperator, Role::kProgrammer));
  EXPECT_FALSE(may(Role::kViewer, Role::kOperator));
}

TEST(Role, IsReadAsItIsSpelled) {
  for (const Role role : kRoles) EXPECT_EQ(role_from(to_text(role)), role);
  EXPECT_FALSE(role_from("Programmer"));
  EXPECT_FALSE(role_from(""));
}

}  // namespace
}  // namespace fieldcast

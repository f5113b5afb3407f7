#include "core/access/login_brake.hpp"

#include <gtest/gtest.h>

#include "core/access/role.hpp"

namespace fieldcast {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const Instant kStart{std::chrono::hours{1}};

void fail(LoginBrake& brake, unsigned times, const std::string& user = "ann", const std::string& peer = "10.0.0.1") {
  for (unsigned i = 0; i < times; ++i) brake.failed(user, peer, kStart);
}

TEST(LoginBrake, LetsTheFirstAttemptsComeAtOnce) {
  LoginBrake brake;
  fail(brake, LoginBrake::kFreeOfUser - 1);
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart), Duration{});
}

TEST(LoginBrake, DoublesTheWaitWithEveryFurtherFailureUpToItsLimit) {
  LoginBrake brake;
  fail(brake, LoginBrake::kFreeOfUser);
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart), seconds{1});
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart + seconds{1}), Duration{});
  fail(brake, 1);
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart), seconds{2});
  fail(brake, 100);
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart), LoginBrake::kLongest);
}

TEST(LoginBrake, DoesNotLockAUserOutWhoLogsInFromElsewhere) {
  LoginBrake brake;
  fail(brake, 5, "ann", "10.0.0.66");
  EXPECT_GT(brake.wait("ann", "10.0.0.66", kStart), Duration{});
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart), Duration{});
}

TEST(LoginBrake, SlowsAPeerDownThatTriesManyUsers) {
  LoginBrake brake;
  for (unsigned i = 0; i < LoginBrake::kFreeOfPeer; ++i) fail(brake, 1, "user" + std::to_string(i));
  EXPECT_EQ(brake.wait("another", "10.0.0.1", kStart), seconds{1});
  EXPECT_EQ(brake.wait("another", "10.0.0.2", kStart), Duration{});
}

TEST(LoginBrake, ForgivesTheUserWhoSucceedsButNotThePeer) {
  LoginBrake brake;
  fail(brake, LoginBrake::kFreeOfPeer - 1);
  brake.succeeded("ann", "10.0.0.1");
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", kStart), Duration{});
  fail(brake, 1);
  EXPECT_EQ(brake.wait("bob", "10.0.0.1", kStart), seconds{1});
}

TEST(LoginBrake, ForgetsAfterAQuietTime) {
  LoginBrake brake;
  fail(brake, 50);
  const Instant later = kStart + LoginBrake::kForget;
  brake.failed("ann", "10.0.0.1", later);
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", later), Duration{});
}

TEST(LoginBrake, HoldsABoundedNumberOfKeysAndKeepsTheNewest) {
  LoginBrake brake;
  for (std::size_t i = 0; i < 2 * LoginBrake::kMaxKeys; ++i) { brake.failed("u", std::to_string(i), kStart + seconds{i}); }
  const Instant now = kStart + seconds{2 * LoginBrake::kMaxKeys};
  for (int i = 0; i < 3; ++i) brake.failed("ann", "10.0.0.1", now);
  EXPECT_EQ(brake.wait("ann", "10.0.0.1", now), seconds{1});
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

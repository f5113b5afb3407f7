#include <gtest/gtest.h>

#include "core/access/login.hpp"
#include "core/access/network.hpp"

namespace fieldcast::access {
namespace {

bool within(std::string_view network, std::string_view address) {
  const auto parsed = Network::parse(network);
  EXPECT_TRUE(parsed) << network;
  return parsed && parsed->contains(address);
}

// The text is "ADDRESS in NETWORK".
bool holds(std::string_view text) {
  const auto at = text.find(" in ");
  return within(text.substr(at + 4), text.substr(0, at));
}

TEST(Network, HoldsTheAddressesOfItsPrefix) {
  for (const auto text :
       {"10.255.0.1 in 10.0.0.0/8", "192.168.7.128 in 192.168.7.128/25",
        "192.168.7.255 in 192.168.7.128/25", "203.0.113.9 in 0.0.0.0/0", "10.1.2.3 in 10.1.2.3",
        "fd12:3456::7 in fd00::/8", "0:0:0:0:0:0:0:1 in ::1", "1:2:3:4:5:6:7:8 in 1:2:3:4:5:6:7:8",
        "2001:db8::1 in ::/0", "10.0.0.1 in 10.0.0.0/31", "10.0.0.7 in 10.0.0.7/32",
        "fd00::1 in fd00::1/128", "1:2:3:4:5:6:102:304 in 1:2:3:4:5:6:1.2.3.4",
        "1:2:3:4:5:6:7:0 in 1:2:3:4:5:6:7::"})
    EXPECT_TRUE(holds(text)) << text;
  for (const auto text : {"11.0.0.1 in 10.0.0.0/8", "192.168.7.127 in 192.168.7.128/25",
                          "10.1.2.4 in 10.1.2.3", "fe80::7 in fd00::/8", "10.0.0.2 in 10.0.0.0/31",
                          "10.0.0.6 in 10.0.0.7/32", "fd00::2 in fd00::1/128"})
    EXPECT_FALSE(holds(text)) << text;
}

TEST(Role, EachIncludesThoseBefore) {
  EXPECT_EQ(role_from("engineer"), Role::kEngineer);
  EXPECT_EQ(role_from("administrator"), std::nullopt);
  for (const Role role : kRoles) {
    EXPECT_EQ(role_from(to_text(role)), role);
    EXPECT_TRUE(may(Role::kEngineer, role));
    EXPECT_TRUE(may(role, Role::kViewer));
  }
  EXPECT_FALSE(may(Role::kProgrammer, Role::kEngineer));
  EXPECT_EQ(to_text(static_cast<Role>(99)), "?");
}

TEST(Network, AnAddressIsReadInEverySpellingOfASocket) {
  for (const auto text : {"[fd00::7] in fd00::/8", "[fe80::7%eth0] in fe80::/10",
                          "::ffff:10.0.0.7 in 10.0.0.0/8", "[::ffff:10.0.0.7] in 10.0.0.0/8"})
    EXPECT_TRUE(holds(text)) << text;
  for (const auto text : {"::10.0.0.7 in 10.0.0.0/8", "fd00::1 in 0.0.0.0/0"})
    EXPECT_FALSE(holds(text)) << text;
}

TEST(Network, WhatIsNotAnAddressIsInNoNetwork) {
  for (const char* address :
       {"", "?", "plant", "10.0.0", "10.0.0.256", "1::2::3", ":", "[", "1:2:3"})
    EXPECT_FALSE(within("0.0.0.0/0", address) || within("::/0", address)) << address;
}

TEST(Network, WhatIsNotANetworkIsRefused) {
  for (const char* text : {"",
                           "/8",
                           "10.0.0.0/",
                           "10.0.0.0/33",
                           "10.0.0.0/0008",
                           "10.0.0.0/8/8",
                           "10.0.0.7/8",
                           "010.0.0.1",
                           "10.0.0.0/-1",
                           "10.0.0.0/ 8",
                           "fd00::/129",
                           "fd00::1/8",
                           "[fd00::1]",
                           "fe80::1%eth0",
                           "12345::",
                           "1:2:3:4:5:6:7",
                           "1:2:3:4:5:6:7:8:9",
                           "::1.2.3.4.5",
                           "1:2:3:4:5:1.2.3.4",
                           "1:2:3:4:5:6:7:1.2.3.4",
                           "1:2:3:4:5:6:7::8",
                           "host",
                           "::1::",
                           "1:",
                           ":1"})
    EXPECT_FALSE(Network::parse(text)) << text;
}

TEST(AddressGroup, Ipv6CountsByItsSlash64AndAMappedAddressAsIpv4) {
  EXPECT_EQ(address_group("10.0.0.7"), "10.0.0.7");
  EXPECT_EQ(address_group("[2001:db8:1:2:3:4:5:6]"), "2001:db8:1:2::/64");
  EXPECT_EQ(address_group("2001:db8:1:2::9"), "2001:db8:1:2::/64");
  EXPECT_EQ(address_group("2001:db8:1:3::9"), "2001:db8:1:3::/64");
  EXPECT_EQ(address_group("[fe80::1%eth0]"), "fe80:0:0:0::/64");
  EXPECT_EQ(address_group("[::1]"), "0:0:0:0::/64");
  EXPECT_EQ(address_group("[::ffff:10.0.0.7]"), "10.0.0.7");
  EXPECT_EQ(address_group("?"), "?");
  EXPECT_EQ(address_group("[?%eth0]"), "?");
  EXPECT_EQ(address_group(""), "");
}

}  // namespace
}  // namespace fieldcast::access

namespace fieldcast {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const Instant kStart{std::chrono::hours{1}};

void fail(LoginThrottle& throttle, unsigned times, const std::string& user = "ann",
          const std::string& peer = "10.0.0.1") {
  for (unsigned i = 0; i < times; ++i) throttle.failed(user, peer, kStart);
}

TEST(LoginThrottle, LetsTheFirstAttemptsComeImmediately) {
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

// Regression: each address of an IPv6 network had its own free attempts.
TEST(LoginThrottle, CountsTheAddressesOfASlash64AsOnePeer) {
  LoginThrottle throttle;
  const auto address = [](unsigned host) { return "2001:db8:1:2::" + std::to_string(host); };
  for (unsigned i = 0; i < LoginThrottle::kFreeOfUser; ++i) fail(throttle, 1, "ann", address(i));
  EXPECT_EQ(throttle.wait("ann", address(99), kStart), seconds{1});
  EXPECT_EQ(throttle.wait("ann", "2001:db8:1:3::1", kStart), Duration{});
  EXPECT_EQ(throttle.wait("bob", address(99), kStart), Duration{});
  for (unsigned i = LoginThrottle::kFreeOfUser; i < LoginThrottle::kFreeOfPeer; ++i)
    fail(throttle, 1, "user" + std::to_string(i), address(i));
  EXPECT_EQ(throttle.wait("bob", address(99), kStart), seconds{1});
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

TEST(LoginThrottle, ForgetsTheOldestKeysWhenItIsFull) {
  LoginThrottle throttle;
  fail(throttle, 5, "ann", "10.0.0.9");
  const Instant later = kStart + seconds{1};
  EXPECT_GT(throttle.wait("ann", "10.0.0.9", later), Duration{});
  // Each failure adds the key of the peer and that of its user.
  for (std::size_t i = 0; i < LoginThrottle::kMaxKeys / 2; ++i)
    throttle.failed("u", std::to_string(i), later);
  EXPECT_EQ(throttle.wait("ann", "10.0.0.9", later), Duration{});
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

#include "core/access/network.hpp"

#include <gtest/gtest.h>

namespace fieldcast::access {
namespace {

bool within(const char* network, const char* address) {
  const auto parsed = Network::parse(network);
  EXPECT_TRUE(parsed) << network;
  return parsed && parsed->contains(address);
}

TEST(Network, HoldsTheAddressesOfItsPrefix) {
  EXPECT_TRUE(within("10.0.0.0/8", "10.255.0.1"));
  EXPECT_FALSE(within("10.0.0.0/8", "11.0.0.1"));
  EXPECT_TRUE(within("192.168.7.128/25", "192.168.7.128"));
  EXPECT_TRUE(within("192.168.7.128/25", "192.168.7.255"));
  EXPECT_FALSE(within("192.168.7.128/25", "192.168.7.127"));
  EXPECT_TRUE(within("0.0.0.0/0", "203.0.113.9"));
  EXPECT_TRUE(within("10.1.2.3", "10.1.2.3"));
  EXPECT_FALSE(within("10.1.2.3", "10.1.2.4"));
  EXPECT_TRUE(within("fd00::/8", "fd12:3456::7"));
  EXPECT_FALSE(within("fd00::/8", "fe80::7"));
  EXPECT_TRUE(within("::1", "0:0:0:0:0:0:0:1"));
  EXPECT_TRUE(within("1:2:3:4:5:6:7:8", "1:2:3:4:5:6:7:8"));
  EXPECT_TRUE(within("::/0", "2001:db8::1"));
}

TEST(Network, AnAddressIsReadInEverySpellingOfASocket) {
  EXPECT_TRUE(within("fd00::/8", "[fd00::7]"));
  EXPECT_TRUE(within("fe80::/10", "[fe80::7%eth0]"));
  EXPECT_TRUE(within("10.0.0.0/8", "::ffff:10.0.0.7"));
  EXPECT_TRUE(within("10.0.0.0/8", "[::ffff:10.0.0.7]"));
  EXPECT_FALSE(within("10.0.0.0/8", "::10.0.0.7"));
  EXPECT_FALSE(within("0.0.0.0/0", "fd00::1"));
}

TEST(Network, WhatIsNoAddressIsInNoNetwork) {
  for (const char* address :
       {"", "?", "plant", "10.0.0", "10.0.0.256", "1::2::3", ":", "[", "1:2:3"})
    EXPECT_FALSE(within("0.0.0.0/0", address) || within("::/0", address)) << address;
}

TEST(Network, WhatIsNoNetworkIsRefused) {
  for (const char* text : {"",
                           "/8",
                           "10.0.0.0/",
                           "10.0.0.0/33",
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
                           "1:2:3:4:5:6:7::8",
                           "host",
                           "::1::",
                           "1:",
                           ":1"})
    EXPECT_FALSE(Network::parse(text)) << text;
}

}  // namespace
}  // namespace fieldcast::access

#include "tools/station/settings/origin_check.hpp"

#include <gtest/gtest.h>

namespace fieldcast::web {
namespace {

TEST(HostList, TheAddressAndTheLoopbackAreServedWithThePort) {
  const HostList list({"10.0.0.7", 8090}, {}, true);
  for (const char* host :
       {"10.0.0.7:8090", "localhost:8090", "LOCALHOST:8090", "127.0.0.1:8090", "[::1]:8090"})
    EXPECT_TRUE(list.serves(host)) << host;
  for (const char* host : {"10.0.0.7", "10.0.0.7:80", "10.0.0.70:8090", "evil.example:8090", "",
                           "localhost", ":8090", "localhost:8090.", "localhost:8090:8090"})
    EXPECT_FALSE(list.serves(host)) << host;
}

TEST(HostList, NamesAreServedWithTheirPortOrThisOne) {
  const HostList list({"0.0.0.0", 8090}, {"Station.plant", "other.plant:444", "[fe80::1]"}, true);
  for (const char* host :
       {"station.plant", "STATION.plant:8090", "other.plant:444", "[fe80::1]:8090", "[FE80::1]"})
    EXPECT_TRUE(list.serves(host)) << host;
  for (const char* host : {"station.plant:444", "other.plant", "0.0.0.0:8090", "0.0.0.0"})
    EXPECT_FALSE(list.serves(host)) << host;
}

TEST(HostList, BrowsersLeaveOutTheUsualPort) {
  EXPECT_TRUE(HostList({"::1", 443}, {}, true).serves("[::1]"));
  EXPECT_TRUE(HostList({"127.0.0.1", 80}, {}, false).serves("127.0.0.1"));
  EXPECT_FALSE(HostList({"127.0.0.1", 443}, {}, false).serves("127.0.0.1"));
}

TEST(Origin, OnlyTheSameSchemeHostAndPortIsTheSame) {
  EXPECT_TRUE(same_origin("http://127.0.0.1:8090", "127.0.0.1:8090", false));
  EXPECT_TRUE(same_origin("https://Station.plant", "station.PLANT", true));
  for (const char* origin :
       {"", "null", "127.0.0.1:8090", "https://127.0.0.1:8090", "http://127.0.0.1",
        "http://127.0.0.1:8091", "http://localhost:8090", "http://127.0.0.1:8090/",
        "http://127.0.0.1:8090.evil.example", "http://evil.example", "http://"})
    EXPECT_FALSE(same_origin(origin, "127.0.0.1:8090", false)) << origin;
  EXPECT_FALSE(same_origin("http://", "", false));
}

TEST(HostName, NamesAndAddressesMayHaveAPort) {
  for (const char* text :
       {"station", "station.plant", "station.plant:444", "10.0.0.7", "[::1]", "[fe80::1]:80"})
    EXPECT_TRUE(is_host_name(text)) << text;
  for (const char* text : {"", ":80", "a b", "a:0", "a:65536", "a:x", "a:", "[]", "[::1", "::1",
                           "http://a", "a/b", "[g::1]", "a:1:2"})
    EXPECT_FALSE(is_host_name(text)) << text;
}

}  // namespace
}  // namespace fieldcast::web

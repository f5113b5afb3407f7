#include <gtest/gtest.h>

#include <functional>

#include "bridge/standby/bus_guard.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Instant kBegan{std::chrono::hours{1}};

Duration settled_after(bool in_group, const std::function<Finding(Duration)>& at) {
  Settling settling(in_group, kBegan);
  Duration after{};
  while (after < 1min && settling.waits_for(at(after), kBegan + after)) after += 10ms;
  return after;
}

TEST(Settling, WhoIsAloneWaitsASecond) {
  const auto nobody = [](Duration) { return Finding{}; };
  EXPECT_EQ(settled_after(false, nobody), 1s);
  EXPECT_EQ(settled_after(true, nobody), 1s);
}

TEST(Settling, AMemberWaitsForADiscoveryServerAndForWhatItKnows) {
  const auto server = [](Duration answers) {
    return [answers](Duration after) { return Finding{true, after >= answers}; };
  };
  EXPECT_EQ(settled_after(true, server(100ms)), 2100ms);
  EXPECT_EQ(settled_after(true, server(4s)), 6s);
  EXPECT_EQ(settled_after(true, server(1h)), Settling::kMostInGroup);
  EXPECT_EQ(settled_after(false, server(1h)), 1s) << "a bridge without a group is as before";
}

TEST(Settling, WhoIsThereAndNotKnownYetIsWaitedFor) {
  const auto known = [](Duration from) {
    return [from](Duration after) { return Finding{.unknown = after < from ? 1u : 0u}; };
  };
  EXPECT_EQ(settled_after(true, known(500ms)), 1s);
  EXPECT_EQ(settled_after(true, known(2s)), 2290ms) << "until it is heard as a member, too";
  EXPECT_EQ(settled_after(true, known(1h)), Settling::kMostInGroup);
  EXPECT_EQ(settled_after(false, known(1h)), Settling::kMost);
}

// Behind a discovery server, a killed bridge may look like a silent one.
TEST(Settling, WhoIsSilentIsNotWaitedForAsLong) {
  const auto silent = [](Duration) { return Finding{.silent = 1}; };
  EXPECT_EQ(settled_after(true, silent), Settling::kMost);
  EXPECT_EQ(settled_after(false, silent), Settling::kMost);
}

}  // namespace
}  // namespace fieldcast

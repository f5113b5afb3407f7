#include "core/program/reconnection.hpp"

#include <gmock/gmock.h>

namespace fieldcast::program {
namespace {

using std::chrono::seconds;
using EndKind = PortEnd::Kind;
using Pause = std::optional<Duration>;

constexpr Instant kEndedAt{seconds{1000}};

TEST(Reconnection, PausesDoubleUpToAMinute) {
  Reconnection reconnection;
  const PortEnd lost{EndKind::kBridgeGone, {}, "lost"};
  for (const int pause : {1, 2, 4, 8, 16, 32, 60, 60})
    EXPECT_EQ(reconnection.ended(lost, kEndedAt), Pause(seconds{pause}));
}

TEST(Reconnection, ALongPairingResetsThePauses) {
  Reconnection reconnection;
  const PortEnd lost{EndKind::kDeviceLost, {}, "lost"};
  EXPECT_EQ(reconnection.ended(lost, kEndedAt), Pause(seconds{1}));
  reconnection.paired(kEndedAt);
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{9}), Pause(seconds{2}));
  reconnection.paired(kEndedAt);
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{10}), Pause(seconds{1}));
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{60}), Pause(seconds{2}));
}

TEST(Reconnection, ARefusedLoginAndAStopAreFinal) {
  Reconnection reconnection;
  const auto refused = [](Reply reply) { return PortEnd{EndKind::kRefused, reply, "refused"}; };
  EXPECT_EQ(reconnection.ended(refused(Reply::kNotAllowed), kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended({EndKind::kStopped, {}, "stopped"}, kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended({EndKind::kProtocol, {}, "no bridge"}, kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended(refused(Reply::kInUse), kEndedAt), Pause(seconds{1}));
  EXPECT_EQ(reconnection.ended(refused(Reply::kNotOnline), kEndedAt), Pause(seconds{2}));
}

}  // namespace
}  // namespace fieldcast::program

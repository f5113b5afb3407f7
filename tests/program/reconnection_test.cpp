#include "core/program/reconnection.hpp"

#include <gmock/gmock.h>

namespace fieldcast::program {
namespace {

using std::chrono::seconds;
using EndKind = PortEnd::Kind;
using Next = std::optional<Reconnection::Next>;

Next after(int pause) { return Reconnection::Next{.pause = seconds{pause}}; }

constexpr Instant kEndedAt{seconds{1000}};

TEST(Reconnection, PausesDoubleUpToAMinute) {
  Reconnection reconnection;
  const PortEnd lost{EndKind::kBridgeGone, {}, "lost"};
  for (const int pause : {1, 2, 4, 8, 16, 32, 60, 60})
    EXPECT_EQ(reconnection.ended(lost, kEndedAt), after(pause));
}

TEST(Reconnection, ALongPairingResetsThePauses) {
  Reconnection reconnection;
  const PortEnd lost{EndKind::kDeviceLost, {}, "lost"};
  EXPECT_EQ(reconnection.ended(lost, kEndedAt), after(1));
  reconnection.paired(kEndedAt);
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{9}), after(2));
  reconnection.paired(kEndedAt);
  reconnection.program_sent(kEndedAt + seconds{9});
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{10}), after(1));
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{60}), after(2));
}

TEST(Reconnection, ADeviceThatWasNotInUseIsPairedWhenTheProgramSends) {
  Reconnection reconnection;
  const PortEnd lost{EndKind::kDeviceLost, {}, "lost"};
  const Next when_program_sends = Reconnection::Next{.when_program_sends = true};
  reconnection.paired(kEndedAt);
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{10}), when_program_sends);
  reconnection.paired(kEndedAt);
  reconnection.program_sent(kEndedAt + seconds{1});
  EXPECT_EQ(reconnection.ended(lost, kEndedAt + seconds{10}), after(1));
  reconnection.paired(kEndedAt);
  EXPECT_EQ(reconnection.ended({EndKind::kBridgeGone, {}, "lost"}, kEndedAt + seconds{10}),
            after(1));
}

TEST(Reconnection, ARefusedLoginAndAStopAreFinal) {
  Reconnection reconnection;
  const auto refused = [](Reply reply) { return PortEnd{EndKind::kRefused, reply, "refused"}; };
  EXPECT_EQ(reconnection.ended(refused(Reply::kNotAllowed), kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended({EndKind::kStopped, {}, "stopped"}, kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended({EndKind::kProtocol, {}, "no bridge"}, kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended({static_cast<EndKind>(99), {}, "unknown"}, kEndedAt), std::nullopt);
  EXPECT_EQ(reconnection.ended(refused(Reply::kInUse), kEndedAt), after(1));
  EXPECT_EQ(reconnection.ended(refused(Reply::kNotOnline), kEndedAt), after(2));
}

}  // namespace
}  // namespace fieldcast::program

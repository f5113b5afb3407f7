// Tests the messages if multicast discovery fails. e2e_machine.py uses a real machine.
#include <gtest/gtest.h>

#include "bridge/dds/transport/network_check.hpp"

namespace fieldcast {
namespace {

TEST(Multicast, IsOnTheLoopbackOfThisMachine) {
  EXPECT_EQ(multicast_fault("127.0.0.1"), std::nullopt);
}

TEST(Multicast, OfWhatIsNoAddressOfThisMachineNothingIsSaid) {
  EXPECT_EQ(multicast_fault("192.0.2.77"), std::nullopt);
  EXPECT_EQ(multicast_fault("eth0"), std::nullopt);
}

}  // namespace
}  // namespace fieldcast

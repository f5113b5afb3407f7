// Tests that the validator refuses each known attack with the named cause. The same datagram
// without the fault must pass, so that no other part of it is refused.
#include "tests/bridge/dds/transport/known_attacks.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using testing::Attack;
using testing::known_attacks;

TEST(KnownAttacks, TheValidatorRefusesEachWithItsCause) {
  for (const Attack& attack : known_attacks()) {
    const auto fault = fault_of(attack.datagram, RtpsLimits{});
    ASSERT_TRUE(fault.has_value()) << attack.name;
    EXPECT_EQ(to_text(*fault), to_text(attack.fault)) << attack.name;
  }
}

TEST(KnownAttacks, WithoutTheFaultEachIsTaken) {
  for (const Attack& attack : known_attacks()) {
    if (attack.right.empty()) continue;
    const auto fault = fault_of(attack.right, RtpsLimits{});
    EXPECT_FALSE(fault.has_value()) << attack.name << ": " << to_text(fault.value_or(RtpsFault{}));
  }
}

}  // namespace
}  // namespace fieldcast

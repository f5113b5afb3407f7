#include "tools/sim/families/s7_tcp_device.hpp"

#include <gtest/gtest.h>

#include "tests/tools/sim/device_setup.hpp"

namespace fieldcast::sim {
namespace {

Reaction reaction_to(std::string_view hex) {
  const auto device = make_s7_tcp_device(test::device_setup(1));
  const auto receiver = (*device)->open_receiver();
  Reaction reaction;
  const Bytes request = *from_hex(hex);
  for (const std::uint8_t byte : request) receiver->on_character(byte, test::kBegin, reaction);
  return reaction;
}

TEST(S7TcpDevice, AConnectToAnotherPlaceIsRefusedWithItsReference) {
  const Reaction refused = reaction_to("03 00 00 0F 0A E0 00 00 12 34 00 C2 02 01 05");
  EXPECT_EQ(to_hex(refused.response), "03 00 00 0B 06 80 12 34 00 00 03");
  EXPECT_TRUE(refused.hang_up);
}

TEST(S7TcpDevice, AConnectWithoutAReferenceEndsTheConnection) {
  const Reaction ended = reaction_to("03 00 00 07 02 E0 00");
  EXPECT_EQ(to_hex(ended.response), "");
  EXPECT_TRUE(ended.hang_up);
}

}  // namespace
}  // namespace fieldcast::sim

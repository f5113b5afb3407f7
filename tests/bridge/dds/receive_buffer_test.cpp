#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "bridge/dds/transport/network_check.hpp"

namespace fieldcast {
namespace {

TEST(ReceiveBuffer, LessThanAskedForIsToldWithItsRemedy) {
  EXPECT_EQ(
      receive_buffer_remark(212'992, 1 << 20),
      "the kernel holds 208 KiB of what comes by UDP where 1024 KiB were asked for: bursts of "
      "many channels get lost and are sent again; remedy: sysctl -w "
      "net.core.rmem_max=1048576");
  EXPECT_EQ(receive_buffer_remark(1 << 20, 1 << 20), std::nullopt);
  EXPECT_EQ(receive_buffer_remark(4 << 20, 1 << 20), std::nullopt);
  EXPECT_EQ(receive_buffer_remark(std::nullopt, 1 << 20), std::nullopt) << "nobody knows";
}

TEST(ReceiveBuffer, IsGrantedUpToTheLimitOfTheKernel) {
  std::uint64_t limit = 0;
  if (!(std::ifstream("/proc/sys/net/core/rmem_max") >> limit)) GTEST_SKIP() << "no such file";
  constexpr std::uint32_t kModest = 65'536;
  EXPECT_EQ(granted_receive_buffer(kModest), std::min<std::uint64_t>(limit, kModest));
  const auto most = static_cast<std::uint32_t>(std::min<std::uint64_t>(2 * limit, 1 << 30));
  EXPECT_EQ(granted_receive_buffer(most), std::min<std::uint64_t>(limit, most));
}

TEST(ReceiveBuffer, OfAProfileOfTheUserNothingIsTold) {
  DdsSpec spec;
  spec.profile = "dds.xml";
  EXPECT_EQ(receive_buffer_remark(spec), std::nullopt);
}

}  // namespace
}  // namespace fieldcast

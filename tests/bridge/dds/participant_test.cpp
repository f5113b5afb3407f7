#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/guard_transport.hpp"
#include "bridge/dds/transport/join_check.hpp"
#include "bridge/dds/transport/network_check.hpp"

namespace fieldcast {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

// Data from participant 01 0f 01 02 .. 0a to a discovery server: INFO_TS, and DATA with the
// parameter 800f, which says that `author` wrote it with the number `upper` * 2^32 + 7.
Bytes announced(std::uint8_t author, std::uint8_t upper, std::uint8_t entity = 0xc2) {
  return {
      'R',   'T',  'P', 'S',  2,    2, 1, 15,     1, 15, 1, 2,      3, 4, 5, 6,
      7,     8,    9,   10,   0x09, 1, 8, 0,      5, 0,  0, 0,      0, 0, 0, 0,       // 20
      0x15,  7,    56,  0,                                                            // 32
      0,     0,    16,  0,                                                            //
      0,     1,    0,   0xc7, 0,    1, 0, entity,                                     // to, from
      0,     0,    0,   0,    7,    0, 0, 0,                                          //
      0x0f,  0x80, 24,  0,                                                            // 56
      1,     15,   1,   2,    3,    4, 5, 6,      7, 8,  9, author, 0, 1, 0, entity,  //
      upper, 0,    0,   0,    7,    0, 0, 0,                                          // 76
      1,     0,    0,   0,                                                            //
      0,     3,    0,   0                                                             // the message
  };
}

TEST(ParticipantNumber, AnAnnouncementGetsANumberAboveAllOfAServer) {
  EXPECT_EQ(with_number_above_servers(announced(10, 0)), announced(10, 1));
}

// INFO_TS without a time has length 0, which does not extend to the end of the message.
TEST(ParticipantNumber, AnAnnouncementIsFoundBehindAnEmptySubmessage) {
  const auto without_instant = [](Bytes bytes) {
    bytes[21] |= 2;
    bytes[22] = 0;
    bytes.erase(bytes.begin() + 24, bytes.begin() + 32);
    return bytes;
  };
  EXPECT_EQ(with_number_above_servers(without_instant(announced(10, 0))),
            without_instant(announced(10, 1)));
}

TEST(ParticipantNumber, ItIsTheSameEachTime) {
  EXPECT_EQ(with_number_above_servers(announced(10, 1)), announced(10, 1));
}

TEST(ParticipantNumber, WhatOthersWroteIsSentAsItIs) {
  EXPECT_TRUE(with_number_above_servers(announced(11, 0)).empty());
}

TEST(ParticipantNumber, WhatIsSaidOfEndpointsIsSentAsItIs) {
  EXPECT_TRUE(with_number_above_servers(announced(10, 0, 0x03)).empty());
}

// Also runs under the sanitizers, which detect reads beyond the end of a message.
TEST(ParticipantNumber, AnyBytesAreReadWithinTheMessage) {
  std::mt19937 random(1);
  int changed = 0;
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = announced(10, 0);
    for (unsigned n = random() % 4; n > 0; --n)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
    if (random() % 2 == 0) bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();
    const Bytes other = with_number_above_servers(bytes);
    changed += !other.empty();
    EXPECT_TRUE(other.empty() || other.size() == bytes.size());
  }
  EXPECT_GT(changed, 0);
}

// Tests the messages if multicast discovery fails. e2e_machine.py uses a real machine.

TEST(Multicast, IsOnTheLoopbackOfThisMachine) {
  EXPECT_EQ(multicast_fault("127.0.0.1"), std::nullopt);
}

TEST(Multicast, OfWhatIsNotAnAddressOfThisMachineNothingIsSaid) {
  EXPECT_EQ(multicast_fault("192.0.2.77"), std::nullopt);
  EXPECT_EQ(multicast_fault("eth0"), std::nullopt);
}

TEST(ReceiveBuffer, LessThanAskedForIsReportedWithItsRemedy) {
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

TEST(ReceiveBuffer, OfAProfileOfTheUserNothingIsReported) {
  DdsSpec spec;
  spec.profile = "dds.xml";
  EXPECT_EQ(receive_buffer_remark(spec), std::nullopt);
}

// Tests which discovery server addresses are rejected. e2e_sites.py uses a real server.

using Addresses = std::vector<std::string>;

std::optional<std::string> fault_of(const std::string& server, const Addresses& interfaces) {
  const Addresses own{"127.0.0.1", "10.0.0.3", "10.0.0.7"};
  return server_fault({{server + ":11811", server, 11811}}, own, interfaces);
}

TEST(DiscoveryServer, AtAnAddressOfThisMachineThatDdsIsNotToUseIsAFault) {
  for (const Addresses& interfaces : {Addresses{"10.0.0.7"}, Addresses{"127.0.0.1"}}) {
    const auto fault = fault_of("10.0.0.3", interfaces);
    ASSERT_TRUE(fault);
    EXPECT_THAT(*fault, AllOf(HasSubstr("discovery server 10.0.0.3:11811"),
                              HasSubstr('[' + interfaces.front() + ']'),
                              HasSubstr("name 10.0.0.3 in interfaces")));
  }
}

TEST(DiscoveryServer, ElsewhereOrAtAnAddressThatIsUsedIsNone) {
  EXPECT_EQ(fault_of("10.0.0.3", {"10.0.0.7", "10.0.0.3"}), std::nullopt);
  EXPECT_EQ(fault_of("10.0.0.3", {}), std::nullopt) << "all there are";
  EXPECT_EQ(fault_of("10.0.0.9", {"10.0.0.7"}), std::nullopt) << "another machine";
  EXPECT_EQ(fault_of("127.0.0.1", {"10.0.0.7"}), std::nullopt) << "the loopback is always used";
  EXPECT_EQ(fault_of("127.0.0.2", {"10.0.0.7"}), std::nullopt);
}

TEST(DiscoveryServer, EachOfSeveralIsLookedAt) {
  const auto fault =
      server_fault({{"a:1", "10.0.0.9", 1}, {"b:2", "10.0.0.3", 2}}, {"10.0.0.3"}, {"127.0.0.1"});
  ASSERT_TRUE(fault);
  EXPECT_THAT(*fault, HasSubstr("discovery server b:2: 10.0.0.3 is"));
}

TEST(DiscoveryServer, HasAnAddressAndAPort) {
  const ServerAddress server = server_address("10.0.0.2:11811");
  EXPECT_EQ(server.address, "10.0.0.2");
  EXPECT_EQ(server.port, 11811);
  for (const char* const text : {"10.0.0.2", "10.0.0.2:", "10.0.0.2:0", "10.0.0.2:65536"})
    EXPECT_THROW((void)server_address(text), DdsError) << text;
}

TEST(DiscoveryServer, TheLoopbackIsAnAddressOfThisMachine) {
  const auto own = own_addresses();
  ASSERT_TRUE(own);
  EXPECT_THAT(*own, Contains("127.0.0.1"));
}

}  // namespace
}  // namespace fieldcast

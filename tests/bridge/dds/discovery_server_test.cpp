// Tests which discovery server addresses are rejected. e2e_sites.py uses a real server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/join_check.hpp"

namespace fieldcast {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
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

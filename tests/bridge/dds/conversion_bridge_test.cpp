#include <gtest/gtest.h>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {
namespace {

TEST(BridgeConversion, BringsEveryFieldThere) {
  const BridgeClaims claims{
      "line-7", "host", "boot/pid:[1]/7/8", {5}, {{"one", {{6}, true}}, {"two", {{7}, false}}}};
  idl::Bridge topic;
  to_idl(claims, topic);
  EXPECT_EQ(from_idl(topic), claims);
  EXPECT_FALSE(std::string(topic.version().c_str()).empty());
}

TEST(BridgeConversion, LeavesOutWhatDoesNotFit) {
  BridgeClaims claims;
  for (int i = 0; i <= kMaxBuses; ++i) claims.buses["bus-" + std::to_string(i)] = {};
  idl::Bridge topic;
  to_idl(claims, topic);
  EXPECT_EQ(topic.buses().size(), static_cast<std::size_t>(kMaxBuses));
  to_idl(BridgeClaims{}, topic);
  EXPECT_TRUE(topic.buses().empty());
}

}  // namespace
}  // namespace fieldcast

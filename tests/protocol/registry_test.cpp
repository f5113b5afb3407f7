#include <gtest/gtest.h>

#include <set>

#include "core/protocol/protocol.hpp"

namespace fieldcast {
namespace {

TEST(Registry, EveryProtocolIsFoundByItsName) {
  std::set<std::string_view> names;
  for (const ProtocolEntry& entry : protocols()) {
    EXPECT_EQ(find_protocol(entry.name), &entry);
    EXPECT_FALSE(entry.summary.empty());
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " twice";
  }
  EXPECT_TRUE(names.contains("modbus-rtu"));
  EXPECT_TRUE(names.contains("modbus-ascii"));
  EXPECT_TRUE(names.contains("modbus-tcp"));
  EXPECT_EQ(find_protocol("modbus"), nullptr);
}

TEST(Registry, AProtocolKnowsItsOwnNameAndAreas) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 1});
    ASSERT_TRUE(made.has_value()) << entry.name << ": " << made.error().what;
    EXPECT_EQ((*made)->traits().name, entry.name);
    EXPECT_FALSE((*made)->areas().empty());
    for (const Area& area : (*made)->areas()) {
      EXPECT_GT(area.items, 0u);
      EXPECT_TRUE(area.item_bits == 1 || area.item_bits == 8 || area.item_bits == 16 || area.item_bits == 32 ||
                  area.item_bits == 64);
    }
  }
}

TEST(Registry, AnUnknownOptionIsAFaultOfThatOption) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 1, .options = {{"no-such-option", "1"}}});
    ASSERT_FALSE(made.has_value()) << entry.name;
    EXPECT_EQ(made.error().option, "no-such-option");
  }
}

TEST(Registry, AnAddressOutsideTheFamilyIsAFault) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 40000});
    ASSERT_FALSE(made.has_value()) << entry.name;
    EXPECT_EQ(made.error().option, "");
    EXPECT_FALSE(made.error().allowed.empty());
  }
}

}  // namespace
}  // namespace fieldcast

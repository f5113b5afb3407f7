#include <gtest/gtest.h>

#include "bridge/dds/topics/configuration_message.hpp"
#include "idl/topics.h"

namespace fieldcast {
namespace {

using Part = fieldcast_idl::ConfigurationRequest;

std::vector<Part> parts_of(const std::string& text) {
  std::vector<Part> parts;
  to_parts<Part>({"r", 7, "b", text}, [&](Part& part) { parts.push_back(part); });
  return parts;
}

TEST(ConfigurationParts, AreTheTextAgain) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kConfigurationPart,
                                 kConfigurationPart + 1, 3 * kConfigurationPart}) {
    const std::string text(size, 'x');
    ConfigurationParts collected;
    auto last = ConfigurationParts::Added::kOther;
    for (const Part& part : parts_of(text)) last = collected.add(part);
    EXPECT_EQ(last, ConfigurationParts::Added::kWhole);
    EXPECT_EQ(collected.take(), text);
  }
}

TEST(ConfigurationParts, ALostPartIsNoticed) {
  const auto parts = parts_of(std::string(3 * kConfigurationPart, 'x'));
  ConfigurationParts collected;
  EXPECT_EQ(collected.add(parts[0]), ConfigurationParts::Added::kMore);
  EXPECT_EQ(collected.add(parts[2]), ConfigurationParts::Added::kOther);
}

TEST(ConfigurationParts, AreBounded) {
  Part part = parts_of(std::string(2 * kConfigurationPart, 'x')).front();
  ConfigurationParts collected;
  auto added = ConfigurationParts::Added::kMore;
  std::uint32_t count = 0;
  for (; added == ConfigurationParts::Added::kMore && count < 1000; ++count) {
    part.part(count);
    added = collected.add(part);
  }
  EXPECT_EQ(added, ConfigurationParts::Added::kOther);
  EXPECT_EQ(count, ConfigurationMessage::kMostBytes / kConfigurationPart + 1);
}

}  // namespace
}  // namespace fieldcast

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/cli/model/watch_model.hpp"

namespace fieldcast::cli {
namespace {

using testing::HasSubstr;

Catalogue plant() {
  Catalogue catalogue;
  for (const auto* name : {"oil-temperature", "running"}) {
    StationChannel channel;
    channel.bus = "press-shop";
    channel.device = "press-1";
    channel.channel = name;
    catalogue.add(channel);
  }
  return catalogue;
}

TEST(Catalogue, FindsByThePath) {
  const auto catalogue = plant();
  EXPECT_NE(catalogue.find({"press-shop", "press-1", "running"}), nullptr);
  EXPECT_EQ(catalogue.find({"press-shop", "press-1", "speed"}), nullptr);
  EXPECT_TRUE(catalogue.has_device("press-shop", "press-1"));
  EXPECT_FALSE(catalogue.has_device("press-shop", "press-2"));
  EXPECT_EQ(catalogue.count(Pattern::parse("*/*/oil*").value()), 1u);
}

TEST(Catalogue, AChannelOrDeviceInPlaceOfABusIsFound) {
  const auto catalogue = plant();
  const auto meant = [&](const char* pattern) {
    return catalogue.meant_further_down(Pattern::parse(pattern).value());
  };
  EXPECT_EQ(meant("running"), "*/*/running");
  EXPECT_EQ(meant("press-1"), "*/press-1/*");
  EXPECT_EQ(meant("press-1/running"), "*/press-1/running");
  EXPECT_EQ(meant("speed"), "");
  EXPECT_EQ(meant("press-shop/press-1/speed"), "");
}

TEST(Catalogue, NamesThePartThatIsUnknownAndWhatWasMeant) {
  const auto catalogue = plant();
  EXPECT_EQ(
      catalogue.explain_unknown({"press-shop", "press-1", "oil-temprature"}),
      "channel 'oil-temprature' is unknown in press-shop/press-1; did you mean oil-temperature?");
  EXPECT_THAT(catalogue.explain_unknown({"press-shop", "press-1", "zzz"}),
              HasSubstr("there are oil-temperature, running"));
  EXPECT_THAT(catalogue.explain_unknown({"press-shop", "lathe", "running"}),
              HasSubstr("device 'lathe' is unknown on bus press-shop"));
  EXPECT_THAT(catalogue.explain_unknown({"pres-shop", "press-1", "running"}),
              HasSubstr("did you mean press-shop?"));
  EXPECT_EQ(Catalogue{}.explain_unknown({"a", "b", "c"}), "no device is announced at all");
}

TEST(Catalogue, ADeviceForAddressesAloneIsThereWithoutChannels) {
  Catalogue catalogue;
  EXPECT_TRUE(catalogue.empty());
  EXPECT_TRUE(catalogue.add_device("line", "meter"));
  EXPECT_FALSE(catalogue.add_device("line", "meter"));
  EXPECT_FALSE(catalogue.empty());
  EXPECT_TRUE(catalogue.has_device("line", "meter"));
  EXPECT_THAT(catalogue.explain_unknown({"line", "metre", "x"}), HasSubstr("did you mean meter?"));
  EXPECT_EQ(catalogue.explain_unknown({"line", "meter", "x"}),
            "device 'meter' has no channels; --at ADDRESS reads and writes addresses");
}

}  // namespace
}  // namespace fieldcast::cli

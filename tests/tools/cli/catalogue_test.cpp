#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/text_cases.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/model/watch_model.hpp"

namespace fieldcast::cli {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

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
  const auto meant = [&](std::string_view pattern) {
    return catalogue.meant_further_down(Pattern::parse(pattern).value());
  };
  test::expect_texts(
      meant, {"running -> */*/running", "press-1 -> */press-1/*",
              "press-1/running -> */press-1/running", "speed -> ", "press-shop/press-1/speed -> "});
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

constexpr Instant kBegan{100s};

Connection sites() { return Connection{std::vector<DdsSite>{{"north", {}}, {"south", {}}}}; }

TEST(Listening, ToNobodyTakesAsLongAsABridgeMay) {
  const Listening alone(Connection{DdsSpec{}}, kBegan);
  EXPECT_FALSE(alone.anybody());
  EXPECT_EQ(alone.over_at(), kBegan + kBridgeWait);
}

TEST(Listening, IsOverWhenNothingNewCame) {
  Listening alone(Connection{DdsSpec{}}, kBegan);
  alone.news("line", kBegan + 1s);
  EXPECT_EQ(alone.over_at(), kBegan + 1s + kQuietTime);
  alone.news("press", kBegan + 1500ms);
  EXPECT_EQ(alone.over_at(), kBegan + 1500ms + kQuietTime);
  EXPECT_EQ(alone.silent_text(), "");
}

TEST(Listening, WaitsForEachSite) {
  Listening both(sites(), kBegan);
  both.news("north:line", kBegan + 1s);
  EXPECT_EQ(both.over_at(), kBegan + kBridgeWait);
  EXPECT_TRUE(both.heard_site_of("north:other"));
  EXPECT_FALSE(both.heard_site_of("south:line"));
  EXPECT_EQ(both.silent_text(), "no bridge found in site south");
  EXPECT_EQ(both.silent_sites(), std::vector<std::string>{"south"});
  both.news("south:line", kBegan + 2s);
  EXPECT_EQ(both.over_at(), kBegan + 2s + kQuietTime);
  EXPECT_EQ(both.silent_text(), "");
}

TEST(Listening, LetsALateReporterContinue) {
  Listening both(sites(), kBegan);
  both.news("north:line", kBegan + 4800ms);
  EXPECT_EQ(both.over_at(), kBegan + 4800ms + kQuietTime);
}

TEST(Listening, ABusWithoutASiteIsOfAnybody) {
  Listening both(sites(), kBegan);
  EXPECT_FALSE(both.heard_site_of("line"));
  both.news("north:line", kBegan + 1s);
  EXPECT_TRUE(both.heard_site_of("line"));
}

}  // namespace
}  // namespace fieldcast::cli

#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::Json;

class ChannelsApiTest : public test::ApiTest {
 protected:
  void announce(const std::string& device, const std::string& name) {
    StationChannel channel;
    channel.bridge = "b1";
    channel.bus = "line";
    channel.device = device;
    channel.channel = name;
    channel.type = "float32";
    channel.unit = "bar";
    model_.on_channel(channel);
  }
  void SetUp() override {
    announce("d-1", "a");
    announce("d", "b");
    announce("d", "a");
    add_routes(table_, {.model = &model_});
  }
  [[nodiscard]] std::string names(const std::string& query) {
    std::string text;
    for (const auto& each : json("/api/channels" + query))
      text += each.at("channel").get<std::string>() + ' ';
    return text;
  }

  LiveModel model_{1000};
};

TEST_F(ChannelsApiTest, ChannelsAreListedByPatternAndInParts) {
  EXPECT_EQ(names(""), "line/d/a line/d/b line/d-1/a ");
  EXPECT_EQ(names("?pattern=*/*/a"), "line/d/a line/d-1/a ");
  EXPECT_EQ(names("?limit=1"), "line/d/a ");
  EXPECT_EQ(names("?limit=1&after=line/d/a"), "line/d/b ");
  EXPECT_EQ(names("?after=line/d-1/a"), "");
  EXPECT_EQ(ask("/api/channels?after=line").status, 400u);
  EXPECT_EQ(ask("/api/channels?limit=0").status, 400u);
}

TEST_F(ChannelsApiTest, TheCatalogueIsWholeOrWhatChanged) {
  const Json whole = json("/api/catalogue");
  EXPECT_EQ(whole.at("full"), true);
  EXPECT_EQ(whole.at("channels").size(), 3u);
  const std::string after = "/api/catalogue?after=" + whole.at("version").dump();
  EXPECT_EQ(json(after).at("channels").size(), 0u);
  announce("d", "c");
  const Json change = json(after);
  EXPECT_EQ(change.at("full"), false);
  EXPECT_EQ(change.at("channels").size(), 1u);
  EXPECT_EQ(ask("/api/catalogue?after=x").status, 400u);
}

TEST_F(ChannelsApiTest, TheCompressedCatalogueIsMadeOnceForAll) {
  HttpRequest request = test::request_of("/api/catalogue");
  request.accepts_gzip = true;
  const auto first = ask(request).shared_body;
  ASSERT_TRUE(first);
  EXPECT_EQ(ask(request).shared_body, first);
  EXPECT_EQ(Json::parse(test::unzipped(*first)).at("channels").size(), 3u);
  announce("d", "c");
  const auto second = ask(request).shared_body;
  EXPECT_EQ(Json::parse(test::unzipped(*second)).at("channels").size(), 4u);
}

TEST_F(ChannelsApiTest, WhatElseTheDomainReportsIsListed) {
  StationBusStatus bus;
  bus.bus = "line";
  bus.bridge = "b1";
  model_.put(bus);
  StationDeviceStatus device;
  device.bus = "line";
  device.device = "d";
  model_.put(device);
  EXPECT_EQ(json("/api/buses").at(0).at("bus"), "line");
  EXPECT_EQ(json("/api/devices").at(0).at("device"), "d");
  EXPECT_EQ(json("/api/sessions").size(), 0u);
  EXPECT_EQ(json("/api/bridges").size(), 0u);
  EXPECT_EQ(ask("/api/buses?x=1").status, 400u);
}

}  // namespace
}  // namespace fieldcast::web

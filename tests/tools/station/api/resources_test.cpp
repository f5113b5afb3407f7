#include "bridge/store/users/user_table.hpp"
#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/administration.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::Json;
using test::utc;

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
  model_.put(StationDeviceDescription{.bus = "line", .device = "d", .protocol = "s7-ppi"});
  EXPECT_EQ(json("/api/devices").at(0).at("protocol"), "s7-ppi");
  model_.put(Interest{"panel", "line/*", std::chrono::seconds{1}});
  EXPECT_EQ(json("/api/interests").at(0).at("station"), "panel");
  EXPECT_EQ(json("/api/sessions").size(), 0u);
  EXPECT_EQ(json("/api/bridges").size(), 0u);
  EXPECT_EQ(ask("/api/buses?x=1").status, 400u);
}

TEST_F(ChannelsApiTest, TheSitesOfAStreamAreListed) {
  EXPECT_TRUE(json("/api/sites").at("stream").is_null());
  model_.put(LiveStream{.connected = false, .reason = "disconnected"});
  LiveSite site;
  site.site = "north";
  site.backlog_records = 12;
  model_.put(site);
  const auto found = json("/api/sites");
  EXPECT_EQ(found.at("stream").at("reason"), "disconnected");
  EXPECT_EQ(found.at("sites").at(0).at("site"), "north");
  EXPECT_EQ(found.at("sites").at(0).at("backlog_records"), 12);
  EXPECT_TRUE(found.at("sites").at(0).at("heard_ms").is_null());
}

using AlarmsApiTest = test::ApiTest;

TEST_F(AlarmsApiTest, ThePresentComesFromTheModel) {
  LiveModel model;
  LiveAlarm alarm;
  alarm.bus = "line";
  alarm.state = "unacknowledged";
  alarm.active = true;
  model.put(alarm);
  add_routes(table_, {.model = &model, .now = now()});
  EXPECT_EQ(json("/api/alarms").at("alarms").at(0).at("bus"), "line");
  EXPECT_EQ(ask("/api/alarms?from=1h").status, 404u) << "there is no store";
  EXPECT_EQ(ask("/api/alarms?form=1h").status, 400u);
}

TEST_F(AlarmsApiTest, TheHistoryReportsTheNewestFirstAndNothingTwice) {
  const AlarmRecord raised{"line", "press", "level", "high", "active", 101, utc(kNow - 20)};
  const AlarmEvent seen{.at = utc(kNow - 10),
                        .alarm = {"line", "press", "level", LimitKind::kHigh},
                        .kind = AlarmEventKind::kAcknowledged,
                        .by = "anna",
                        .note = "seen"};
  store([&](Store& to) {
    for (int i = 0; i < 2; ++i) {
      to.put(raised);
      to.put(seen);
    }
  });
  const LiveModel model;
  add_routes(table_, {.model = &model, .database = database(), .now = now()});
  const auto events = json("/api/alarms?from=1h").at("events");
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].at("event"), "acknowledged");
  EXPECT_EQ(events[0].at("who"), "anna");
  EXPECT_TRUE(events[0].at("value").is_null());
  EXPECT_EQ(events[1].at("event"), "raised");
  EXPECT_EQ(events[1].at("value"), 101);
  EXPECT_EQ(json("/api/alarms?from=1h&limit=1").at("events").size(), 1u);
}

using AuditApiTest = test::ApiTest;

TEST_F(AuditApiTest, TheNewestEntriesComeFirst) {
  store([](Store& to) {
    for (int i = 0; i < 5; ++i)
      to.append({.at = utc(kNow - 10 + i),
                 .who = "anna",
                 .what = "write " + std::to_string(i),
                 .target = "line/d/c",
                 .result = "done"});
  });
  add_routes(table_, {.database = database(), .now = now()});
  const auto entries = json("/api/audit?limit=2").at("entries");
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].at("what"), "write 4");
  EXPECT_EQ(entries[1].at("what"), "write 3");
  EXPECT_EQ(entries[0].at("at_ms"), utc(kNow - 6).nanoseconds / 1'000'000);
  EXPECT_EQ(json("/api/audit?to=1700000000000").at("entries").size(), 0u);
}

TEST_F(AuditApiTest, OnlyOperatorsSeeTheAuditAndTheUsers) {
  add_routes(table_, {});
  for (const char* const path : {"/api/audit", "/api/users"}) {
    const auto refused = table_.find(Method::kGet, path, Role::kViewer);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().status, 403u);
  }
}

TEST_F(AuditApiTest, UsersAreShownWithoutTheirHashes) {
  {
    const auto connection = open_store(address(), IfMissing::kCreate);
    ASSERT_TRUE(UserTable(*connection).add("anna", Role::kOperator, "a long password", utc(1)));
  }
  add_routes(table_, {.database = database()});
  const HttpResponse response = ask("/api/users");
  EXPECT_EQ(response.body,
            R"({"users":[{"user":"anna","role":"operator","created_ms":1700000001000}]})");
}

using PlanApiTest = test::ApiTest;

TEST_F(PlanApiTest, IsWhatTheBridgeReports) {
  LiveModel model;
  add_routes(table_, {.model = &model});
  const HttpResponse none = ask("/api/plan?bus=line");
  EXPECT_EQ(none.status, 404u);
  EXPECT_NE(none.body.find("no bridge publishes a plan"), std::string::npos);
  EXPECT_EQ(json("/api/plan").size(), 0u);
  StationReadPlan plan;
  plan.bus = "line";
  model.put(plan);
  EXPECT_EQ(json("/api/plan?bus=line").at("bus"), "line");
  EXPECT_EQ(json("/api/plan").size(), 1u);
}

class DocumentApiTest : public test::ApiTest {
 protected:
  void SetUp() override { add_routes(table_, {}); }
};

TEST_F(DocumentApiTest, ADocumentIsShownAsText) {
  const HttpResponse response = ask("/api/document?name=station.md");
  EXPECT_EQ(response.status, 200u);
  EXPECT_EQ(response.content_type, "text/plain; charset=utf-8");
  EXPECT_EQ(response.body.substr(0, 2), "# ");
}

TEST_F(DocumentApiTest, NoOtherFileIsShown) {
  for (const char* name : {"", "..%2FREADME.md", "%2Fetc%2Fpasswd", "station.md%2F..", "Doxyfile",
                           "README.md", "..md"})
    EXPECT_EQ(ask(std::string("/api/document?name=") + name).status, 400u) << name;
  EXPECT_EQ(ask("/api/document?name=no-such.md").status, 404u);
}

}  // namespace
}  // namespace fieldcast::web

#include "tools/station/model/live_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/station/live/live_support.hpp"

namespace fieldcast::web {
namespace {

using Json = nlohmann::json;

TEST(LiveJson, ABusHasTheFieldsOfItsTopic) {
  StationBusStatus bus = bus_of("shop");
  bus.report.utilisation = 0.25;
  bus.causes["CHECKSUM"] = 3;
  bus.reported_at = {1'763'833'200'123'000'000};
  const Json json = Json::parse(bus_json(bus));
  EXPECT_EQ(json["state"], "running");
  EXPECT_EQ(json["utilisation"], 0.25);
  EXPECT_EQ(json["causes"], Json({{"CHECKSUM", 3}}));
  EXPECT_EQ(json["reported_ms"], 1'763'833'200'123.0);
  EXPECT_FALSE(json.contains("closed_because"));
  EXPECT_FALSE(json.contains("clock_ahead_ms"));
  bus.clock_ahead = std::chrono::milliseconds{-1500};
  EXPECT_EQ(Json::parse(bus_json(bus))["clock_ahead_ms"], -1500.0);
}

// Causes come from the network: a forged one must not add a field to the object.
TEST(LiveJson, HostileCausesStayKeys) {
  const std::string forged = "x\":1},\"state\":\"stopped\",\"y\":{\"z";
  const std::string odd = "a\nb\x01<script>\\\u202e\u009b\ufeff";
  StationBusStatus bus = bus_of("shop");
  bus.causes = {{forged, 1}, {odd, 2}};
  bus.misses = {{"\xff", 3}};
  const std::string text = bus_json(bus);
  const Json json = Json::parse(text);
  EXPECT_EQ(json["state"], "running");
  EXPECT_EQ(json["causes"], Json({{forged, 1}, {odd, 2}}));
  EXPECT_EQ(json["misses"], Json({{"\ufffd", 3}}));
  EXPECT_NE(text.find("\\u202e\\u009b\\ufeff"), std::string::npos) << text;

  StationDeviceStatus device = device_of("press", 1);
  device.causes = bus.causes;
  EXPECT_EQ(Json::parse(device_json(device))["causes"], json["causes"]);
}

TEST(LiveJson, ADeviceReportsWhatWasLearnedInMilliseconds) {
  StationDeviceStatus device = device_of("press", 1);
  device.report.response_time = std::chrono::microseconds{1500};
  device.report.areas.push_back({"holding", std::chrono::milliseconds{2}, {}, 60, 0});
  device.report.refused = {"holding:107"};
  const Json json = Json::parse(device_json(device));
  EXPECT_EQ(json["answer_time_ms"], 1.5);
  EXPECT_EQ(json["areas"][0]["answer_time_ms"], 2);
  EXPECT_EQ(json["areas"][0]["largest_block"], 60);
  EXPECT_EQ(json["refused"], Json({"holding:107"}));
}

TEST(LiveJson, AnAlarmThatNobodyTouchedHasNulls) {
  const LiveAlarm alarm = live_alarm(
      {"shop", "press", "oil", LimitKind::kHigh, AlarmState::kActive, 81.5, {2'000'000'000}});
  EXPECT_EQ(
      alarm_json(alarm),
      R"({"bus":"shop","device":"press","channel":"oil","limit":"high",)"
      R"("priority":"medium","state":"unacknowledged","active":true,"value":81.5,)"
      R"("since_ms":2000,"raised_ns":"0","occurrences":0,"chattering":false,"acknowledged_by":"",)"
      R"("acknowledged_ms":null,"note":"","shelved_until_ms":null,"shelved_by":"",)"
      R"("suppressed":""})");
}

TEST(LiveJson, AnOccurrenceHasAllDigitsOfItsTime) {
  StationAlarmStatus status;
  status.status.raised_at = {1'764'360'000'123'456'789};
  EXPECT_EQ(Json::parse(alarm_json(live_alarm(status)))["raised_ns"], "1764360000123456789");
}

TEST(LiveJson, APlanReportsItsTimesInMilliseconds) {
  const Json json = Json::parse(read_plan_json(plan_of("shop")));
  EXPECT_EQ(json["bus"], "shop");
  EXPECT_EQ(json["in_force_since_ms"], 2000);
  EXPECT_EQ(json["load"], 0.25);
  EXPECT_EQ(json["slot_ms"], 94);
  EXPECT_EQ(json["hyperperiod_ms"], 376);
  const Json& group = json["groups"][0];
  EXPECT_EQ(group["device"], "press");
  EXPECT_EQ(group["period_ms"], 94);
  EXPECT_EQ(group["phase_ms"], 12.5);
  EXPECT_EQ(group["slack_ms"], 1.5);
  EXPECT_EQ(group["points"][0],
            Json::parse(R"({"area":"holding","first":100,"count":2,"channels":["force","speed"],
                            "period_ms":188,"phase_ms":106.5,"worst_gap_ms":190,"stretch":1.0})"));
}

TEST(LiveJson, WhatIsNotInATimetableHasNoTimes) {
  StationReadPlan plan = plan_of("shop");
  plan.plan.slot = plan.plan.hyperperiod = {};
  plan.plan.groups[0].period = plan.plan.groups[0].points[0].period = {};
  plan.plan.groups[0].points[0].worst_gap.reset();
  const Json json = Json::parse(read_plan_json(plan));
  EXPECT_TRUE(json["slot_ms"].is_null());
  EXPECT_TRUE(json["hyperperiod_ms"].is_null());
  EXPECT_TRUE(json["groups"][0]["period_ms"].is_null());
  EXPECT_TRUE(json["groups"][0]["phase_ms"].is_null());
  EXPECT_TRUE(json["groups"][0]["points"][0]["phase_ms"].is_null());
  EXPECT_TRUE(json["groups"][0]["points"][0]["worst_gap_ms"].is_null());
}

TEST(LiveJson, SessionsAndBridgesAreObjects) {
  LiveSession live;
  live.session.bus = "shop";
  live.session.device = "press";
  live.session.state = ProgramSessionState::kOpen;
  live.session.who = "anna";
  live.request = "RD read DM";
  live.requested_at = {2'000'000};
  const Json session = Json::parse(session_json(live));
  EXPECT_EQ(session["state"], "open");
  EXPECT_EQ(session["last_request"], "RD read DM");
  EXPECT_EQ(session["last_request_ms"], 2);
  StationBridge bridge;
  bridge.bridge = "line-7";
  bridge.buses.push_back({"shop", {1'000'000}, true});
  const Json json = Json::parse(bridge_json(bridge));
  EXPECT_EQ(json["buses"][0], Json({{"bus", "shop"}, {"since_ms", 1}, {"serving", true}}));
}

TEST(LiveJson, AChannelForScripts) {
  LiveModel model;
  model.on_channel(channel_of("oil"));
  EXPECT_TRUE(Json::parse(channel_json(*model.find(path_of("oil"))))["value"].is_null());
  model.on_sample(sample_of("oil", 21.5));
  const Json json = Json::parse(channel_json(*model.find(path_of("oil"))));
  EXPECT_EQ(json["channel"], "shop/press/oil");
  EXPECT_EQ(json["value"], 21.5);
  EXPECT_EQ(json["quality"], "GOOD");
  EXPECT_EQ(json["acquired_ms"], 1000);
  EXPECT_FALSE(json.contains("device_code"));
}

TEST(LiveJson, ADescriptionCompletesItsDeviceAndItsChannels) {
  const StationDeviceDescription about{.bridge = "line-7",
                                       .bus = "shop",
                                       .device = "press",
                                       .protocol = "modbus-rtu",
                                       .port = "/dev/ttyUSB0 19200 8E1",
                                       .address = "7",
                                       .digits = {{"force", {2, true}}, {"oil", {1, false}}}};
  EXPECT_EQ(Json::parse(description_json(about)),
            Json::parse(R"({"bus":"shop","device":"press","bridge":"line-7",
                "protocol":"modbus-rtu","port":"/dev/ttyUSB0 19200 8E1","address":"7",
                "digits":{"force":2},"resolution":{"oil":1}})"));
  const Json device = Json::parse(device_json(device_of("press", 1), &about));
  EXPECT_EQ(device["protocol"], "modbus-rtu");
  EXPECT_EQ(device["address"], "7");
  EXPECT_FALSE(Json::parse(device_json(device_of("press", 1))).contains("protocol"));
  LiveModel model;
  model.on_channel(channel_of("oil"));
  model.on_channel(channel_of("level"));
  EXPECT_EQ(Json::parse(channel_json(*model.find(path_of("oil")), &about))["digits"], 1);
  EXPECT_FALSE(Json::parse(channel_json(*model.find(path_of("level")), &about)).contains("digits"));
}

TEST(LiveJson, TheCatalogueReportsWhatChangedSinceAVersion) {
  LiveModel model(100);
  StationChannel channel = channel_of("oil");
  channel.limits.high = 80;
  channel.write_max = 90;
  model.on_channel(channel);
  model.on_channel(channel_of("rpm"));
  const Json all = Json::parse(catalogue_json(model, 0));
  EXPECT_EQ(all["version"], 102);
  EXPECT_EQ(all["full"], true);
  EXPECT_EQ(all["channels"][0],
            Json::parse(R"([1, "shop/press/oil", "float32", "°C", "holding:100", "read-write",
                            "scheduled", 500, {"high": 80, "write-max": 90}, "", "line-7"])"));
  model.on_gone(path_of("rpm"));
  const Json delta = Json::parse(catalogue_json(model, 102));
  EXPECT_EQ(delta["full"], false);
  EXPECT_EQ(delta["channels"], Json::array());
  EXPECT_EQ(delta["gone"], Json({2}));
}

TEST(LiveJson, AMessageNamesItsKind) {
  EXPECT_EQ(kind_message("bus_gone", R"({"bus":"shop"})"), R"({"kind":"bus_gone","bus":"shop"})");
  EXPECT_EQ(kind_message("pong", "{}"), R"({"kind":"pong"})");
}

}  // namespace
}  // namespace fieldcast::web

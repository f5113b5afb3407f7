#include "tools/station/api/commands.hpp"

#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::Json;

class FakeCommands final : public CommandSink {
 public:
  Submitted submit(const Caller& caller, StationCommand command, Done) override {
    if (full) return tl::make_unexpected(Refusal{"too many commands", "try again"});
    users.push_back(caller.user);
    commands.push_back(std::move(command));
    return ++last;
  }
  Submitted submit(const Caller& caller, AlarmAction action, Done) override {
    if (full) return tl::make_unexpected(Refusal{"too many commands", "try again"});
    users.push_back(caller.user);
    actions.push_back(std::move(action));
    return ++last;
  }
  std::optional<CommandOutcome> find(std::string_view user, std::uint64_t id) const override {
    if (user != "anna" || id != 1) return std::nullopt;
    CommandOutcome outcome;
    outcome.request_id = 1;
    outcome.user = "anna";
    outcome.state = "verified";
    return outcome;
  }

  bool reaches_stream() const override { return stream; }

  bool full = false, stream = false;
  std::uint64_t last = 0;
  std::vector<std::string> users;
  std::vector<StationCommand> commands;
  std::vector<AlarmAction> actions;
};

class CommandsApiTest : public test::ApiTest {
 protected:
  void SetUp() override {
    StationChannel channel;
    channel.bus = "line";
    channel.device = "d";
    channel.channel = "speed";
    channel.type = "int16";
    model_.on_channel(channel);
    add_routes(table_, {.model = &model_, .commands = &commands_});
  }
  HttpResponse post(const std::string& path, const std::string& body) {
    HttpRequest request = test::request_of(path, Method::kPost);
    request.body = body;
    return ask(request);
  }
  std::string fault(const std::string& path, const std::string& body) {
    const HttpResponse response = post(path, body);
    EXPECT_EQ(response.status, 400u) << response.body;
    return Json::parse(response.body).at("error");
  }

  LiveModel model_;
  FakeCommands commands_;
};

TEST_F(CommandsApiTest, ASiteOfTheStreamAcceptsNoneUnlessTheyAreAllowed) {
  StationChannel channel;
  channel.bus = "north:line";
  channel.device = "d";
  channel.channel = "speed";
  channel.type = "int16";
  model_.on_channel(channel, Origin::kStream);
  LiveSite site;
  site.site = "north";
  model_.put(site);
  for (const auto& [path, body] :
       {std::pair{"/api/commands", R"({"channel":"north:line/d/speed","value":42})"},
        std::pair{"/api/alarms/acknowledge",
                  R"({"alarms":[{"bus":"north:line","device":"d","channel":"c","limit":"high"}]})"},
        std::pair{"/api/sessions/end", R"({"bus":"north:line","device":"d"})"}}) {
    const HttpResponse response = post(path, body);
    EXPECT_EQ(response.status, 409u) << path;
    EXPECT_EQ(Json::parse(response.body).at("error"),
              path == std::string("/api/sessions/end")
                  ? "site north is read from the stream, which carries no actions on devices"
                  : "site north is read from the stream, and this station sends no commands by it");
  }
  EXPECT_EQ(commands_.last, 0u);
  commands_.stream = true;
  EXPECT_EQ(post("/api/commands", R"({"channel":"north:line/d/speed","value":42})").status, 202u);
  EXPECT_EQ(post("/api/alarms/acknowledge",
                 R"({"alarms":[{"bus":"north:line","device":"d","channel":"c","limit":"high"}]})")
                .status,
            202u);
  EXPECT_EQ(post("/api/sessions/end", R"({"bus":"north:line","device":"d"})").status, 409u);
  EXPECT_EQ(commands_.last, 2u);
}

TEST_F(CommandsApiTest, AWriteIsTakenWithTheNameOfThePerson) {
  const HttpResponse response =
      post("/api/commands", R"({"channel":"line/d/speed","value":42,"verify":true})");
  EXPECT_EQ(response.status, 202u);
  EXPECT_EQ(response.body, R"({"request_id":1,"request_ids":[1]})");
  ASSERT_EQ(commands_.commands.size(), 1u);
  EXPECT_EQ(commands_.users[0], "anna");
  EXPECT_EQ(commands_.commands[0].bus, "line");
  EXPECT_EQ(commands_.commands[0].command.values.at(0), Value(std::int64_t{42}));
  EXPECT_TRUE(commands_.commands[0].command.verify);
}

TEST_F(CommandsApiTest, WhatIsNotAWriteIsRefusedWithTheReason) {
  EXPECT_EQ(fault("/api/commands", "[]"), "the body is no JSON object");
  EXPECT_EQ(fault("/api/commands", R"({"channel":"line/d/speed"})"), "the value is missing");
  EXPECT_EQ(fault("/api/commands", R"({"channel":"line","value":1})"), "'line' is no channel");
  EXPECT_EQ(fault("/api/commands", R"({"channel":"line/d/speed","value":"x"})"),
            "'x' is no such value");
  EXPECT_NE(fault("/api/commands", R"({"channel":"line/d/speed","value":1,"x":2})"), "");
  EXPECT_EQ(post("/api/commands", R"({"channel":"line/d/no","value":1})").status, 404u);
  EXPECT_TRUE(commands_.commands.empty());
}

TEST_F(CommandsApiTest, NoMemberOfTheBodyReachesTheMessageAroundIt) {
  EXPECT_EQ(post("/api/commands", R"({"channel":"line/d/speed","value":1},"id":{})").status, 400u);
}

TEST_F(CommandsApiTest, AFullControllerIsReported) {
  commands_.full = true;
  EXPECT_EQ(post("/api/commands", R"({"channel":"line/d/speed","value":1})").status, 503u);
}

TEST_F(CommandsApiTest, TheOutcomeOfACommandIsReportedToItsUser) {
  EXPECT_EQ(json("/api/commands/result?request_id=1").at("state"), "verified");
  EXPECT_EQ(ask("/api/commands/result?request_id=2").status, 404u);
  EXPECT_EQ(ask("/api/commands/result?request_id=x").status, 400u);
  EXPECT_EQ(ask("/api/commands/result").status, 400u);
}

TEST_F(CommandsApiTest, SeveralAlarmsAreAcknowledgedTogether) {
  const HttpResponse response = post("/api/alarms/acknowledge", R"({"alarms":[
      {"bus":"line","device":"d","channel":"speed","limit":"high-high"},
      {"bus":"line","device":"d","channel":"speed","limit":"high"}],"note":"seen"})");
  EXPECT_EQ(response.status, 202u) << response.body;
  EXPECT_EQ(Json::parse(response.body).at("request_ids").size(), 2u);
  ASSERT_EQ(commands_.actions.size(), 2u);
  EXPECT_EQ(commands_.actions[0].kind, AlarmActionKind::kAcknowledge);
  EXPECT_EQ(commands_.actions[0].alarm.limit, LimitKind::kHighHigh);
  EXPECT_EQ(commands_.actions[1].note, "seen");
}

// Regression: an occurrence that nobody had seen was acknowledged.
TEST_F(CommandsApiTest, AnAcknowledgementNamesTheOccurrence) {
  const auto body = [](const std::string& raised) {
    return R"({"alarms":[{"bus":"line","device":"d","channel":"c","limit":"low","raised_ns":)" +
           raised + "}]}";
  };
  EXPECT_EQ(post("/api/alarms/acknowledge", body("\"1764360000123456789\"")).status, 202u);
  EXPECT_EQ(commands_.actions.at(0).raised_at.nanoseconds, 1'764'360'000'123'456'789);
  EXPECT_EQ(post("/api/alarms/unshelve", body("\"5\"")).status, 202u);
  EXPECT_EQ(commands_.actions.at(1).raised_at, UtcTime{}) << "of any occurrence";
  for (const char* const bad : {"5", "null", "\"\"", "\"5x\"", "\"99999999999999999999\""})
    EXPECT_EQ(fault("/api/alarms/acknowledge", body(bad)), "this is no time of an occurrence");
}

TEST_F(CommandsApiTest, ShelvingHasAnEnd) {
  const std::string alarm =
      R"("alarms":[{"bus":"line","device":"d","channel":"speed","limit":"low"}])";
  EXPECT_EQ(post("/api/alarms/shelve", "{" + alarm + R"(,"minutes":30})").status, 202u);
  EXPECT_EQ(commands_.actions.at(0).duration, std::chrono::minutes{30});
  for (const char* const bad : {"0", "1441", "-5", "1.5", "\"30\"", "null"})
    EXPECT_NE(fault("/api/alarms/shelve", "{" + alarm + ",\"minutes\":" + bad + "}"), "") << bad;
  EXPECT_NE(fault("/api/alarms/shelve", "{" + alarm + "}"), "");
  EXPECT_EQ(post("/api/alarms/unshelve", "{" + alarm + "}").status, 202u);
}

TEST_F(CommandsApiTest, MaintenanceOfZeroMinutesEndsIt) {
  EXPECT_EQ(post("/api/alarms/maintenance", R"({"bus":"line","device":"d","minutes":120})").status,
            202u);
  EXPECT_EQ(post("/api/alarms/maintenance", R"({"bus":"line","device":"d","minutes":0})").status,
            202u);
  EXPECT_EQ(commands_.actions.at(0).kind, AlarmActionKind::kMaintenance);
  EXPECT_EQ(commands_.actions.at(0).duration, std::chrono::hours{2});
  EXPECT_EQ(commands_.actions.at(1).kind, AlarmActionKind::kEndMaintenance);
}

TEST_F(CommandsApiTest, AProgrammingSessionIsEnded) {
  const char* const path = "/api/sessions/end";
  EXPECT_EQ(post(path, R"({"bus":"line","device":"d","note":"the night shift starts"})").status,
            202u);
  EXPECT_EQ(commands_.actions.at(0).kind, AlarmActionKind::kEndSession);
  EXPECT_EQ(commands_.actions.at(0).alarm.device, "d");
  EXPECT_EQ(commands_.actions.at(0).note, "the night shift starts");
  EXPECT_EQ(fault(path, R"({"bus":"line"})"), "device is missing, or no name");
  EXPECT_NE(fault(path, R"({"bus":"line","device":"d","minutes":1})"), "");
}

TEST_F(CommandsApiTest, BodiesAboutAlarmsThatAreNoneSayWhatIsWrong) {
  const char* const path = "/api/alarms/acknowledge";
  EXPECT_EQ(fault(path, "{}"), "alarms is missing, empty or too long");
  EXPECT_EQ(fault(path, R"({"alarms":[]})"), "alarms is missing, empty or too long");
  EXPECT_EQ(fault(path, R"({"alarms":[1]})"), "an alarm is an object");
  EXPECT_EQ(fault(path, R"({"alarms":[{"bus":"b"}]})"), "device is missing, or no name");
  EXPECT_EQ(fault(path, R"({"alarms":[{"bus":"b","device":"d","channel":"c","limit":"top"}]})"),
            "this is no limit");
  EXPECT_EQ(fault(path, R"({"alarms":[],"by":"root"})"), "'by' is unknown here");
  EXPECT_EQ(
      fault(path, R"({"alarms":[{}],"note":)" + std::string("\"") + std::string(257, 'x') + "\"}"),
      "the note cannot be used");
  std::string many = R"({"alarms":[)";
  for (std::size_t i = 0; i <= kMaxAlarmsAtOnce; ++i) many += i == 0 ? "{}" : ",{}";
  EXPECT_EQ(fault(path, many + "]}"), "alarms is missing, empty or too long");
  EXPECT_TRUE(commands_.actions.empty());
}

TEST_F(CommandsApiTest, OnlyOperatorsDoAnything) {
  for (const Route* route : table_.rows()) {
    const bool acts = route->method != Method::kGet || route->path.starts_with("/api/commands");
    EXPECT_TRUE(!acts || route->access >= Access::kOperator) << route->path;
  }
}

}  // namespace
}  // namespace fieldcast::web

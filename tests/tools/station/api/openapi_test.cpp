// Compares tools/station/openapi.yaml with the table of routes and with actual responses.
#include <set>

#include "config/document/document.hpp"
#include "tests/config/json_schema.hpp"
#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/dashboard/dashboard_table.hpp"
#include "tools/station/report/report_table.hpp"
#include "tools/station/web/site.hpp"

namespace fieldcast::web {
namespace {

using Plain = nlohmann::json;
using test::utc;

const Plain& document() {
  static const Plain kDocument = [] {
    config::FaultList faults;
    const auto parsed =
        config::parse_yaml({"openapi.yaml", std::string(openapi_text()), 0}, faults);
    return parsed->root == nullptr || !faults.empty() ? Plain() : config::json_of(*parsed->root);
  }();
  return kDocument;
}

class NoCommands final : public CommandSink {
 public:
  Submitted submit(const Caller&, StationCommand, Done) override { return 1; }
  Submitted submit(const Caller&, AlarmAction, Done) override { return 1; }
  std::optional<CommandOutcome> find(std::string_view, std::uint64_t) const override {
    CommandOutcome outcome;
    outcome.state = "pending";
    return outcome;
  }
};

class OpenApiTest : public test::ApiTest {
 protected:
  OpenApiTest() : site_(spec(), {[] { return Instant{}; }, now()}, {}) {
    add_routes(site_.routes(), needs());
    add_routes(table_, needs());
    fill();
  }
  static SiteSpec spec() {
    SiteSpec made;
    made.listen = {"127.0.0.1", 8090};
    return made;
  }
  Api needs() {
    return {.model = &model_,
            .commands = &commands_,
            .database = database(),
            .reports = &reports_,
            .now = now(),
            .metrics = [] { return std::vector<Metric>{}; }};
  }
  void fill() {
    StationChannel channel;
    channel.bus = "line";
    channel.device = "d";
    channel.channel = "speed";
    channel.type = "int16";
    channel.limits.high = 10;
    model_.on_channel(channel);
    StationBusStatus bus;
    bus.bus = "line";
    bus.causes["CHECKSUM"] = 2;
    model_.put(bus);
    StationDeviceStatus device;
    device.bus = "line";
    device.device = "d";
    device.report.areas.push_back({.area = "holding"});
    model_.put(device);
    model_.put(StationDeviceDescription{
        .bus = "line", .device = "d", .protocol = "modbus-rtu", .digits = {{"speed", {1, true}}}});
    model_.put(Interest{"panel", "line/*", std::chrono::seconds{1}});
    LiveAlarm alarm;
    alarm.bus = "line";
    alarm.state = "unacknowledged";
    alarm.active = true;
    model_.put(alarm);
    model_.put(LiveSession{{.bus = "line", .device = "d"}, "RD read DM", utc(1)});
    StationBridge bridge;
    bridge.bridge = "b";
    bridge.buses.push_back({"line", utc(1), true});
    model_.put(bridge);
    StationReadPlan plan;
    plan.bus = "line";
    plan.plan.groups.push_back({});
    plan.plan.groups[0].points.push_back({});
    model_.put(plan);
    auto connection = open_store(address(), IfMissing::kCreate);
    EXPECT_TRUE(DashboardTable(*connection).save({.name = "pumps", .version = 1, .content = "{}"}));
    EXPECT_TRUE(SavedReportTable(*connection).save({"energy", "c=line", "anna", utc(1)}));
    ReportRunTable(*connection)
        .put({"daily", "folder", "2026-11-28", utc(2), "daily_2026-11-28.csv"});
    EXPECT_EQ(PictureTable(*connection).save({{.name = "boiler", .content = "<svg/>"}, "svg"}), 1);
    store([](Store& to) {
      const auto number = to.number_of({.bus = "line", .device = "d", .channel = "speed"});
      const SampleRow row{
          .channel = *number, .published_at = utc(kNow - 5), .sequence = 1, .value = 1.0};
      to.put(std::span(&row, 1));
      to.append({.at = utc(kNow - 5), .who = "anna", .what = "write 1"});
      to.put(AlarmRecord{"line", "d", "speed", "high", "active", 11, utc(kNow - 5)});
    });
  }

  LiveModel model_{1};
  NoCommands commands_;
  const std::vector<ReportSpec> reports_{
      {.name = "daily", .channels = {Pattern()}, .folder = "/srv", .mail = {"crew"}}};
  Site site_;
};

std::set<std::string> documented() {
  std::set<std::string> found;
  for (const auto& [path, methods] : document().at("paths").items()) {
    for (const auto& [method, about] : methods.items()) {
      std::string upper = method;
      for (char& c : upper) c = static_cast<char>(c - 'a' + 'A');
      found.insert(upper + ' ' + path);
    }
  }
  return found;
}

TEST_F(OpenApiTest, EveryRouteIsInTheDocumentAndEveryPathOfItIsARoute) {
  ASSERT_TRUE(document().is_object()) << "the document cannot be read";
  std::set<std::string> routes;
  for (const Route* route : site_.routes().rows())
    routes.insert(std::string(to_text(route->method)) + ' ' + route->path);
  EXPECT_EQ(documented(), routes);
}

TEST_F(OpenApiTest, WhatIsPublicIsReported) {
  for (const Route* route : site_.routes().rows()) {
    const char* const method = route->method == Method::kGet ? "get" : "post";
    const Plain& about = document().at("paths").at(route->path).at(method);
    EXPECT_EQ(about.contains("security"), route->access == Access::kPublic) << route->path;
  }
}

const Plain& schema_of(const std::string& path, const char* method, const char* status) {
  const Plain* response = &document().at("paths").at(path).at(method).at("responses").at(status);
  if (response->contains("$ref"))
    response =
        &document().at(Plain::json_pointer(response->at("$ref").get<std::string>().substr(1)));
  return response->at("content").at("application/json").at("schema");
}

// Returns all GET targets with a JSON response; required parameters have the document's example.
std::vector<std::string> json_targets() {
  std::vector<std::string> targets;
  for (const ApiRow& row : kApiRows) {
    const Plain& about = document().at("paths").at(row.path);
    // Responses of a bridge: tests/tools/e2e_configure.py.
    if (row.access == Access::kEngineer) continue;
    if (row.method != Method::kGet ||
        !about.at("get").at("responses").at("200").at("content").contains("application/json"))
      continue;
    std::string target = row.path;
    for (const Plain& each : about.at("get").value("parameters", Plain::array())) {
      if (each.value("required", false))
        target +=
            '?' + each.at("name").get<std::string>() + '=' + each.at("example").get<std::string>();
    }
    targets.push_back(target);
  }
  return targets;
}

TEST_F(OpenApiTest, ResponsesAreAsTheDocumentSays) {
  std::vector<std::string> targets = json_targets();
  EXPECT_EQ(targets.size(), 20u);
  targets.insert(targets.end(), {"/api/plan?bus=line", "/api/alarms?from=1h",
                                 "/api/history?channel=line/d/speed&channel=line/d/none"});
  for (const std::string& target : targets) {
    const HttpResponse response = ask(target);
    ASSERT_EQ(response.status, 200u) << target << ' ' << response.body;
    const Plain answer = Plain::parse(response.body);
    const std::string path = target.substr(0, target.find('?'));
    EXPECT_EQ(config::misfit(answer, schema_of(path, "get", "200"), document()), "") << target;
    // An empty list would fit any schema.
    EXPECT_TRUE(!answer.is_array() || !answer.empty()) << target;
  }
  EXPECT_EQ(ask("/api/openapi.yaml").shared_body->substr(0, 8), "openapi:");
}

TEST_F(OpenApiTest, ExamplesFitTheirSchemasAndAreTaken) {
  int examples = 0;
  for (const auto& [path, methods] : document().at("paths").items()) {
    if (!methods.contains("post") || !methods.at("post").contains("requestBody")) continue;
    const bool is_for_bridge = path.starts_with("/api/configuration/");
    const std::string name = methods.at("post").at("requestBody").at("$ref");
    const Plain& content =
        document().at(Plain::json_pointer(name.substr(1))).at("content").at("application/json");
    for (const auto& [key, example] : content.at("examples").items()) {
      ++examples;
      EXPECT_EQ(config::misfit(example.at("value"), content.at("schema"), document()), "") << key;
      if (path == "/api/login" || path == "/api/commands" || is_for_bridge ||
          path == "/api/notifications/test")
        continue;  // an invalid channel; no target
      HttpRequest request = test::request_of(path, Method::kPost);
      request.body = example.at("value").dump();
      const HttpResponse response = ask(request);
      const char* const status = methods.at("post").at("responses").contains("202") ? "202" : "200";
      EXPECT_EQ(std::to_string(response.status), status) << path << ' ' << response.body;
      EXPECT_EQ(
          config::misfit(Plain::parse(response.body), schema_of(path, "post", status), document()),
          "");
    }
  }
  EXPECT_GE(examples, 8);
}

TEST(MetricsText, IsWhatPrometheusReads) {
  EXPECT_EQ(metrics_text({{"clients", false, "Clients.", 3}, {"frames_total", true, "F.", 1e6}}),
            "# HELP fieldcast_station_clients Clients.\n"
            "# TYPE fieldcast_station_clients gauge\n"
            "fieldcast_station_clients 3\n"
            "# HELP fieldcast_station_frames_total F.\n"
            "# TYPE fieldcast_station_frames_total counter\n"
            "fieldcast_station_frames_total 1000000\n");
}

TEST(MetricsText, ValuesOfSitesHaveALabelAndOneDescription) {
  EXPECT_EQ(metrics_text({{"site_backlog_records", false, "B.", 3, "north"},
                          {"site_backlog_records", false, "B.", 4, "a\"b"}}),
            "# HELP fieldcast_station_site_backlog_records B.\n"
            "# TYPE fieldcast_station_site_backlog_records gauge\n"
            "fieldcast_station_site_backlog_records{site=\"north\"} 3\n"
            "fieldcast_station_site_backlog_records{site=\"a\\\"b\"} 4\n");
}

}  // namespace
}  // namespace fieldcast::web

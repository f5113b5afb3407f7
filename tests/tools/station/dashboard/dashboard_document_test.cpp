#include "tools/station/dashboard/dashboard_document.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace fieldcast::web {
namespace {

using Json = nlohmann::json;

Json pumps() {
  return Json::parse(R"({
    "name": "pumps", "title": "Pump ${pump}",
    "parameters": [{"name": "pump", "default": "1", "values": ["1", "2", "3"]}],
    "grid": {"columns": 12, "row_px": 40},
    "widgets": [
      {"kind": "number", "at": [0, 0, 3, 2], "title": "Flow", "channel": "water/pump-${pump}/flow"},
      {"kind": "lamp", "at": [3, 0, 2, 2], "channel": "water/pump-${pump}/running",
       "states": [{"value": true, "text": "Running", "tone": "good"}]},
      {"kind": "table", "at": [0, 2, 6, 4], "pattern": "water/pump-${pump}"}
    ]})");
}

DashboardFaults faults_of(const std::string& text) {
  const auto checked = check_dashboard(text);
  return checked ? DashboardFaults{} : checked.error();
}
DashboardFaults faults_of(const Json& document) { return faults_of(document.dump()); }

// The place of the only fault; the whole text for more faults.
std::string place_of(const Json& document) {
  const DashboardFaults faults = faults_of(document);
  if (faults.size() == 1) return faults[0].place;
  std::string all;
  for (const DashboardFault& fault : faults) all += fault.place + ": " + fault.what + '\n';
  return all;
}

Json with_widget(const char* widget) {
  Json document = pumps();
  document["widgets"] = Json::array({Json::parse(widget)});
  return document;
}

TEST(DashboardDocument, ValidDashboardHasItsNameAndTitle) {
  const auto checked = check_dashboard(pumps().dump());
  ASSERT_TRUE(checked) << checked.error()[0].place << checked.error()[0].what;
  EXPECT_EQ(checked->name, "pumps");
  EXPECT_EQ(checked->title, "Pump ${pump}");
}

TEST(DashboardDocument, EveryKindHasAValidExample) {
  const Json examples = Json::parse(R"({
    "number": {"channel": "a/b/c", "digits": 1},
    "gauge": {"channel": "a/b/c", "min": 0, "max": 10.5},
    "level": {"channel": "a/b/c", "min": -5, "max": 5},
    "lamp": {"channel": "a/b/c", "states": [{"value": 2, "text": "Fault", "tone": "bad"}]},
    "trend": {"channels": ["a/b/c", "a/b/d"], "span": "10min"},
    "bars": {"channels": ["a/b/c"], "min": 0, "max": 1},
    "table": {"pattern": "a/*/c"},
    "alarms": {},
    "button": {"channel": "a/b/c", "value": true, "text": "Start", "verify": true},
    "setpoint": {"channel": "a/b/c"},
    "picture": {"picture": "boiler", "values": [{"channel": "a/b/c", "x": 0, "y": 99.5}]},
    "text": {"text": "Boiler house", "opens": "boilers?hall=1"}})");
  const Json format = Json::parse(dashboard_format());
  EXPECT_EQ(examples.size(), format.at("kinds").size());
  for (const auto& [kind, row] : format.at("kinds").items()) {
    ASSERT_TRUE(examples.contains(kind)) << kind;
    Json widget = examples.at(kind);
    widget["kind"] = kind;
    widget["at"] = {0, 0, 2, 2};
    EXPECT_EQ(place_of(with_widget(widget.dump().c_str())), "") << kind;
    for (const Json& property : row.at("properties")) {
      if (!property.value("required", false)) continue;
      const std::string name = property.at("name");
      Json without = widget;
      without.erase(name);
      EXPECT_EQ(place_of(with_widget(without.dump().c_str())), "widgets[0]." + name) << kind;
    }
  }
}

TEST(DashboardDocument, FaultHasPlaceReasonAndWhatIsAllowed) {
  const DashboardFaults faults =
      faults_of(with_widget(R"({"kind": "number", "at": [0, 0, 1, 1], "channel": "water/flow"})"));
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0],
            (DashboardFault{"widgets[0].channel", "'water/flow' is not a channel",
                            "BUS/DEVICE/CHANNEL, for example press-shop/press-1/speed"}));
}

TEST(DashboardDocument, EachWrongPropertyIsReportedAtItsPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"kind": "dial", "at": [0,0,1,1]})", "widgets[0].kind"},
      {R"({"at": [0,0,1,1]})", "widgets[0].kind"},
      {R"(7)", "widgets[0].kind"},
      {R"({"kind": "text", "text": "x"})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [0,0,0,1]})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [0,0,13,1]})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [-1,0,1,1]})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [0,501,1,1]})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [0,0,1,51]})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [0,0,1.5,1]})", "widgets[0].at"},
      {R"({"kind": "text", "text": "x", "at": [0,0,18446744073709551615,1]})", "widgets[0].at"},
      {R"({"kind": "text", "text": 5, "at": [0,0,1,1]})", "widgets[0].text"},
      {R"({"kind": "text", "text": "x", "colour": "red", "at": [0,0,1,1]})", "widgets[0].colour"},
      {R"({"kind": "text", "text": "x", "opens": "../audit", "at": [0,0,1,1]})",
       "widgets[0].opens"},
      {R"({"kind": "number", "channel": "a/b/c", "digits": 10, "at": [0,0,1,1]})",
       "widgets[0].digits"},
      {R"({"kind": "number", "channel": "a/b/c", "digits": 1.5, "at": [0,0,1,1]})",
       "widgets[0].digits"},
      {R"({"kind": "gauge", "channel": "a/b/c", "min": 5, "max": 5, "at": [0,0,1,1]})",
       "widgets[0].max"},
      {R"({"kind": "trend", "channels": [], "at": [0,0,1,1]})", "widgets[0].channels"},
      {R"({"kind": "trend", "channels": ["a/b/c", "a"], "at": [0,0,1,1]})",
       "widgets[0].channels[1]"},
      {R"({"kind": "trend", "channels": ["a/b/c"], "span": "9y", "at": [0,0,1,1]})",
       "widgets[0].span"},
      {R"({"kind": "table", "pattern": "a/b/c/d", "at": [0,0,1,1]})", "widgets[0].pattern"},
      {R"({"kind": "button", "channel": "a/b/c", "value": null, "text": "x", "at": [0,0,1,1]})",
       "widgets[0].value"},
      {R"({"kind": "setpoint", "channel": "a/b/c", "verify": 1, "at": [0,0,1,1]})",
       "widgets[0].verify"},
      {R"({"kind": "picture", "picture": "<svg>", "at": [0,0,1,1]})", "widgets[0].picture"},
      {R"({"kind": "picture", "picture": "p", "values": [{"channel": "a/b/c", "x": 101, "y": 1}],
          "at": [0,0,1,1]})",
       "widgets[0].values[0].x"},
      {R"({"kind": "lamp", "channel": "a/b/c",
          "states": [{"value": 1, "text": "x", "tone": "pink"}], "at": [0,0,1,1]})",
       "widgets[0].states[0].tone"},
  };
  for (const auto& [widget, place] : cases)
    EXPECT_EQ(place_of(with_widget(widget)), place) << widget;
}

TEST(DashboardDocument, TextOpensADashboardWithParameters) {
  const auto place = [](const std::string& opens) {
    Json document = pumps();
    document["widgets"][0] = {
        {"kind", "text"}, {"at", {0, 0, 1, 1}}, {"text", "x"}, {"opens", opens}};
    return place_of(document);
  };
  for (const char* valid : {"pumps", "pumps?pump=3", "pumps?pump=${pump}&hall=Nord 1"})
    EXPECT_EQ(place(valid), "") << valid;
  for (const char* wrong :
       {"", "Pumps", "pumps?", "pumps?pump", "pumps?pump=", "pumps?=3", "pumps?a=1&",
        "pumps?a=1?b=2", "pumps#x", "../x", "javascript:alert(1)", "pumps?a=${b}"})
    EXPECT_EQ(place(wrong), "widgets[0].opens") << wrong;
}

TEST(DashboardDocument, NameIsPartOfAnAddress) {
  for (const char* name : {"", "Pumps", "a b", "-a", "a/b", "ä", "<b>", "a.b"}) {
    Json document = pumps();
    document["name"] = name;
    EXPECT_EQ(place_of(document), "name") << name;
  }
  EXPECT_TRUE(is_dashboard_name("pump-12"));
  EXPECT_TRUE(is_dashboard_name(std::string(64, 'a')));
  EXPECT_FALSE(is_dashboard_name(std::string(65, 'a')));
}

TEST(DashboardDocument, EachParameterMustBeDeclared) {
  Json document = pumps();
  document["title"] = "Pump ${pmp}";
  ASSERT_EQ(place_of(document), "title");
  EXPECT_EQ(faults_of(document)[0].what, "'${pmp}' is not a parameter");
  EXPECT_EQ(faults_of(document)[0].allowed, "declared parameters: pump");
  document["title"] = "Pump ${pump";
  EXPECT_EQ(place_of(document), "title");
}

TEST(DashboardDocument, ParametersCannotContainParameters) {
  Json document = pumps();
  document["parameters"] = Json::parse(
      R"([{"name": "a", "default": "${b}"}, {"name": "b", "default": "${a}"},
          {"name": "pump", "default": "1"}])");
  const DashboardFaults faults = faults_of(document);
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].place, "parameters[0].default");
  EXPECT_EQ(faults[1].place, "parameters[1].default");
}

TEST(DashboardDocument, ParameterCannotReachOutOfItsPartOfAChannel) {
  for (const char* value : {"1/../2", "*", "1}", "a#b", "a&kiosk=x", ""}) {
    Json document = pumps();
    document["parameters"][0] = {{"name", "pump"}, {"default", value}};
    EXPECT_EQ(place_of(document), "parameters[0].default") << value;
  }
}

TEST(DashboardDocument, DefaultIsOneOfTheValuesAndNamesAreUnique) {
  Json document = pumps();
  document["parameters"][0]["default"] = "4";
  EXPECT_EQ(place_of(document), "parameters[0].default");
  document = pumps();
  document["parameters"].push_back({{"name", "pump"}, {"default", "1"}});
  EXPECT_EQ(place_of(document), "parameters[1].name");
}

TEST(DashboardDocument, WidgetsCannotCoverEachOther) {
  Json document = pumps();
  document["widgets"][1]["at"] = {2, 1, 2, 2};
  const DashboardFaults faults = faults_of(document);
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].what, "the widget covers widgets[0]");
  EXPECT_EQ(faults[1].place, "widgets[2].at");
}

TEST(DashboardDocument, SyntaxFaultHasLineAndColumn) {
  const DashboardFaults faults = faults_of(std::string("{\n  \"name\": \"a\",\n  oops\n}"));
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].place, "line 3, column 3");
  EXPECT_EQ(faults_of(std::string())[0].place, "line 1, column 1");
}

TEST(DashboardDocument, HostileTextsAreRefused) {
  Json many = pumps();
  for (int i = 0; i < 101; ++i)
    many["widgets"].push_back({{"kind", "text"}, {"text", "x"}, {"at", {0, 10 + i, 1, 1}}});
  EXPECT_EQ(place_of(many), "widgets");
  const std::pair<std::string, const char*> cases[] = {
      {std::string(200'000, '['), "document"},
      {std::string(60'000, '['), "line 1"},
      {R"({"a":[[[[[[[[[[1]]]]]]]]]]})", "document"},
      {R"({"name": "a", "name": "b"})", "document"},
      {R"([1])", "document"},
      {R"({"name": 1e999})", "document"},
      {"{\"name\": \"\xff\"}", "line 1"},
      {std::string("{\"name\0\": 1}", 12), "line 1"},
  };
  for (const auto& [text, place] : cases) {
    const DashboardFaults faults = faults_of(text);
    ASSERT_FALSE(faults.empty()) << text.substr(0, 40);
    EXPECT_TRUE(faults[0].place.starts_with(place)) << faults[0].place << text.substr(0, 40);
  }
}

TEST(DashboardDocument, ListOfFaultsIsBounded) {
  Json document = pumps();
  document["widgets"] = Json::array();
  for (int i = 0; i < 100; ++i) document["widgets"].push_back(Json::object());
  EXPECT_EQ(faults_of(document).size(), kMaxDashboardFaults);
}

// The page writes texts as texts, so markup in a title is kept; the message escapes what a terminal
// would interpret.
TEST(DashboardDocument, MarkupIsTextAndControlCharactersAreEscapedInMessages) {
  Json document = pumps();
  document["title"] = "<img src=x onerror=alert(1)>";
  EXPECT_EQ(place_of(document), "");
  document["widgets"][0]["channel"] = "\x1b[31m\u202e";
  EXPECT_EQ(faults_of(document)[0].what, "'\\x1B[31m\\u202E' is not a channel");
}

}  // namespace
}  // namespace fieldcast::web

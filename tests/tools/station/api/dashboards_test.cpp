#include "core/base/json.hpp"
#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/body_limits.hpp"
#include "tools/station/dashboard/picture.hpp"

namespace fieldcast::web {
namespace {

class DashboardsApi : public test::ApiTest {
 protected:
  DashboardsApi() {
    store([](Store&) {});
    add_routes(table_, {.database = database(), .audit = &audit_, .now = now()});
  }

  static test::Json dashboard(const std::string& title = "Pumps") {
    return {{"name", "pumps"},
            {"title", title},
            {"widgets", {{{"kind", "text"}, {"at", {0, 0, 1, 1}}, {"text", "x"}}}}};
  }
  HttpResponse post(const std::string& path, const test::Json& body, Role role = Role::kEngineer) {
    HttpRequest request = test::request_of(path, Method::kPost);
    request.body = body.dump();
    return ask(request, role);
  }
  HttpResponse save(const test::Json& document, int base) {
    return post("/api/dashboards/save", {{"text", document.dump()}, {"base", base}});
  }
  HttpResponse upload(const std::string& name, const std::string& bytes) {
    return post("/api/pictures/save", {{"name", name}, {"data", to_base64(bytes)}});
  }
  static std::string header(const HttpResponse& response, const char* name) {
    for (const auto& [key, value] : response.headers)
      if (key == name) return value;
    return {};
  }

  fieldcast::test::RecordingAudit audit_;
};

TEST_F(DashboardsApi, SavedDashboardIsListedAndShown) {
  const HttpResponse saved = save(dashboard(), 0);
  ASSERT_EQ(saved.status, 200u) << saved.body;
  EXPECT_EQ(test::Json::parse(saved.body)["version"], 1);
  const test::Json list = json("/api/dashboards")["dashboards"];
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["name"], "pumps");
  EXPECT_EQ(list[0]["title"], "Pumps");
  EXPECT_EQ(list[0]["saved_by"], "anna");
  EXPECT_EQ(list[0]["saved_ms"], unix_ms(test::utc(kNow)));
  EXPECT_EQ(json("/api/dashboard?name=pumps")["text"], dashboard().dump());
  EXPECT_EQ(audit_.rows(),
            std::vector<std::string>{"anna from 127.0.0.1 | save dashboard | pumps | done"});
}

TEST_F(DashboardsApi, EarlierVersionsCanBeShown) {
  ASSERT_EQ(save(dashboard("First"), 0).status, 200u);
  ASSERT_EQ(save(dashboard("Second"), 1).status, 200u);
  EXPECT_EQ(json("/api/dashboard?name=pumps&version=1")["text"], dashboard("First").dump());
  EXPECT_EQ(json("/api/dashboard?name=pumps")["version"], 2);
  EXPECT_EQ(ask("/api/dashboard?name=pumps&version=3").status, 404u);
}

TEST_F(DashboardsApi, SecondEngineerSeesAConflictAndNothingChanges) {
  ASSERT_EQ(save(dashboard("First"), 0).status, 200u);
  ASSERT_EQ(save(dashboard("Second"), 1).status, 200u);
  const HttpResponse refused = save(dashboard("Third"), 1);
  EXPECT_EQ(refused.status, 409u);
  EXPECT_NE(refused.body.find("anna has saved version 2 of this dashboard"), std::string::npos)
      << refused.body;
  EXPECT_EQ(save(dashboard("Again"), 0).status, 409u);
  EXPECT_EQ(json("/api/dashboard?name=pumps")["text"], dashboard("Second").dump());
  EXPECT_EQ(post("/api/dashboards/delete", {{"name", "pumps"}, {"base", 1}}).status, 409u);
  EXPECT_EQ(post("/api/dashboards/delete", {{"name", "pumps"}, {"base", 2}}).status, 200u);
  EXPECT_EQ(ask("/api/dashboard?name=pumps").status, 404u);
  EXPECT_EQ(save(dashboard("Late"), 2).status, 409u);
  EXPECT_EQ(audit_.rows().size(), 3u);
}

TEST_F(DashboardsApi, InvalidDashboardIsRefusedWithThePlaceOfTheFault) {
  test::Json wrong = dashboard();
  wrong["widgets"][0]["kind"] = "dial";
  const HttpResponse refused = save(wrong, 0);
  EXPECT_EQ(refused.status, 400u);
  EXPECT_EQ(test::Json::parse(refused.body)["error"],
            "widgets[0].kind: 'dial' is not a kind of widget");
  const HttpResponse checked = post("/api/dashboards/check", {{"text", wrong.dump()}});
  EXPECT_EQ(checked.status, 200u);
  EXPECT_EQ(test::Json::parse(checked.body)["faults"][0]["place"], "widgets[0].kind");
  EXPECT_EQ(test::Json::parse(post("/api/dashboards/check", {{"text", dashboard().dump()}}).body),
            test::Json::parse(R"({"faults": []})"));
  EXPECT_TRUE(json("/api/dashboards")["dashboards"].empty());
  EXPECT_TRUE(audit_.rows().empty());
}

TEST_F(DashboardsApi, WrongRequestsAreRefused) {
  const std::pair<const char*, test::Json> cases[] = {
      {"/api/dashboards/save", {{"text", "{}"}}},
      {"/api/dashboards/save", {{"text", dashboard().dump()}, {"base", -1}}},
      {"/api/dashboards/save", {{"text", dashboard().dump()}, {"base", 1e300}}},
      {"/api/dashboards/save", {{"text", dashboard()}, {"base", 0}}},
      {"/api/dashboards/save", {{"text", dashboard().dump()}, {"base", 0}, {"who", "root"}}},
      {"/api/dashboards/save", {{"text", std::string(200'000, ' ')}, {"base", 0}}},
      {"/api/dashboards/delete", {{"name", "../x"}, {"base", 0}}},
      {"/api/pictures/save", {{"name", "p"}, {"data", "no base64!"}}},
      {"/api/pictures/save", {{"name", "p"}, {"data", to_base64("GIF89a")}}},
      {"/api/pictures/save", {{"name", "a/b"}, {"data", to_base64("x")}}},
  };
  for (const auto& [path, body] : cases) EXPECT_EQ(post(path, body).status, 400u) << path << body;
  for (const char* target : {"/api/dashboard", "/api/dashboard?name=A", "/api/picture?name=..",
                             "/api/dashboard?name=a&version=0", "/api/dashboards?x=1"})
    EXPECT_EQ(ask(target).status, 400u) << target;
  EXPECT_EQ(post("/api/pictures/delete", {{"name", "none"}}).status, 404u);
  EXPECT_EQ(post("/api/dashboards/delete", {{"name", "none"}, {"base", 1}}).status, 404u);
  EXPECT_TRUE(audit_.rows().empty());
}

TEST_F(DashboardsApi, PictureIsServedSanitisedAndWithoutRights) {
  const HttpResponse saved =
      upload("boiler", "<svg viewBox='0 0 3 2' onload='alert(1)'><script>alert(1)</script></svg>");
  ASSERT_EQ(saved.status, 200u) << saved.body;
  const test::Json answer = test::Json::parse(saved.body);
  EXPECT_EQ(answer["removed"], (test::Json{"onload", "script"}));
  EXPECT_EQ(answer["version"], 1);
  const HttpResponse shown = ask("/api/picture?name=boiler&v=1");
  EXPECT_EQ(shown.status, 200u);
  EXPECT_EQ(shown.content_type, "image/svg+xml");
  EXPECT_EQ(shown.body, R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 3 2"></svg>)");
  EXPECT_EQ(header(shown, "content-security-policy"),
            "default-src 'none'; frame-ancestors 'none'; sandbox");
  HttpRequest again = test::request_of("/api/picture?name=boiler");
  again.if_none_match = header(shown, "etag");
  EXPECT_EQ(ask(again).status, 304u);
  ASSERT_EQ(upload("boiler", "<svg viewBox='0 0 1 1'/>").status, 200u);
  EXPECT_EQ(ask(again).status, 200u);
  const test::Json pictures = json("/api/pictures")["pictures"];
  ASSERT_EQ(pictures.size(), 1u);
  EXPECT_EQ(pictures[0]["version"], 2);
  EXPECT_EQ(pictures[0]["width"], 1.0);
  EXPECT_EQ(post("/api/pictures/delete", {{"name", "boiler"}}).status, 200u);
  EXPECT_EQ(ask(again).status, 404u);
}

TEST_F(DashboardsApi, ViewersAndOperatorsChangeNothing) {
  ASSERT_EQ(save(dashboard(), 0).status, 200u);
  const std::pair<const char*, test::Json> cases[] = {
      {"/api/dashboards/check", {{"text", dashboard().dump()}}},
      {"/api/dashboards/save", {{"text", dashboard("Mine").dump()}, {"base", 1}}},
      {"/api/dashboards/delete", {{"name", "pumps"}, {"base", 1}}},
      {"/api/pictures/save", {{"name", "p"}, {"data", to_base64("<svg viewBox='0 0 1 1'/>")}}},
      {"/api/pictures/delete", {{"name", "p"}}},
  };
  int engineers = 0;
  for (const ApiRow& row : kApiRows) engineers += row.access == Access::kEngineer ? 1 : 0;
  EXPECT_GE(engineers, 5);
  for (const auto& [path, body] : cases) {
    for (const Role role : {Role::kViewer, Role::kOperator})
      EXPECT_EQ(post(path, body, role).status, 403u) << path;
    EXPECT_EQ(table_.find(Method::kPost, path, std::nullopt).error().status, 401u) << path;
  }
  EXPECT_EQ(json("/api/dashboard?name=pumps")["text"], dashboard().dump());
  HttpRequest looks = test::request_of("/api/dashboard?name=pumps");
  EXPECT_EQ(ask(looks, Role::kViewer).status, 200u);
}

TEST_F(DashboardsApi, StationWithoutAStoreHasNone) {
  RouteTable bare;
  add_routes(bare, {.now = now()});
  const auto route = bare.find(Method::kGet, "/api/dashboards", Role::kViewer);
  ASSERT_TRUE(route);
  unsigned status = 0;
  (*route)->handler(test::request_of("/api/dashboards"), Caller{"vera", Role::kViewer, ""},
                    [&](const HttpResponse& response) { status = response.status; });
  EXPECT_EQ(status, 404u);
}

}  // namespace
}  // namespace fieldcast::web

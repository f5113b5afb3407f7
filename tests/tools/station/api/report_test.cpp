#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/report/report_table.hpp"

namespace fieldcast::web {
namespace {

using test::Json;
using test::utc;

std::string at_ms(std::int64_t second) {
  return std::to_string(utc(second).nanoseconds / 1'000'000);
}

class ReportApiTest : public test::ApiTest {
 protected:
  // 12 kW for an hour, each second.
  void store_hour() {
    store([](Store& to) {
      const auto number = to.number_of(
          {.bus = "line", .device = "meter", .channel = "p", .unit = "kW", .type = "float64"});
      for (std::int64_t second = 0; second < 3600; second += 10) {
        const SampleRow row{.channel = *number,
                            .published_at = utc(second),
                            .acquired_at = utc(second),
                            .sequence = static_cast<std::uint64_t>(second) + 1,
                            .quality = Quality::kGood,
                            .value = 12.0};
        to.put(std::span(&row, 1));
      }
    });
    add_routes(table_, {.database = database(), .now = now()});
  }
  const std::string range_ = "&from=" + at_ms(0) + "&to=" + at_ms(3600);
};

TEST_F(ReportApiTest, GivesTheTotalsOfEachPeriod) {
  store_hour();
  const Json report = json("/api/report?channel=line/meter/p&channel=no/such/c&by=month" + range_);
  const Json& table = report.at("tables").at(0);
  EXPECT_EQ(table.at("unit"), "kW");
  ASSERT_EQ(table.at("rows").size(), 1u);
  EXPECT_NEAR(table.at("rows").at(0).at("integral").get<double>(), 12, 0.5);  // kWh
  EXPECT_EQ(table.at("rows").at(0).at("mean"), 12);
  EXPECT_EQ(report.at("tables").at(1).at("known"), false);
}

TEST_F(ReportApiTest, IsAlsoCsv) {
  store_hour();
  const HttpResponse response = ask("/api/report?channel=line/meter/p&format=csv" + range_);
  EXPECT_EQ(response.content_type, "text/csv; charset=utf-8");
  EXPECT_NE(response.body.find("\nline/meter/p,kW,"), std::string::npos) << response.body;
}

TEST_F(ReportApiTest, IsAlsoASpreadsheet) {
  store_hour();
  const HttpResponse response = ask("/api/report?channel=line/meter/p&format=xlsx" + range_);
  EXPECT_EQ(response.status, 200u);
  EXPECT_EQ(response.body.substr(0, 2), "PK");
  EXPECT_EQ(response.headers.at(0).second, "attachment; filename=\"report.xlsx\"");
}

TEST_F(ReportApiTest, APatternStandsForItsChannels) {
  store_hour();
  const Json tables =
      json("/api/report?channel=no/such/*&channel=line/*/p&channel=line" + range_).at("tables");
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables.at(0).at("channel"), "line/meter/p");
}

TEST_F(ReportApiTest, RefusesMoreChannelsThanTheLimit) {
  store([](Store& to) {
    for (int i = 0; i < 65; ++i) {
      const auto number = to.number_of({.bus = "line",
                                        .device = "meter",
                                        .channel = "p" + std::to_string(i),
                                        .unit = "kW",
                                        .type = "float64"});
      const SampleRow row{.channel = *number,
                          .published_at = utc(1),
                          .sequence = 1,
                          .quality = Quality::kGood,
                          .value = 1.0};
      to.put(std::span(&row, 1));
    }
  });
  add_routes(table_, {.database = database(), .now = now()});
  const HttpResponse response = ask("/api/report?channel=line" + range_);
  EXPECT_EQ(response.status, 400u);
  EXPECT_NE(response.body.find("65 channels"), std::string::npos) << response.body;
}

TEST_F(ReportApiTest, OtherQueriesDoNotWaitForTheWholeReport) {
  store_hour();
  const HttpRequest request =
      test::request_of("/api/report?channel=line/meter/p&channel=no/such/c" + range_);
  const auto route = table_.find(request.method, request.path, Role::kViewer);
  ASSERT_TRUE(route);
  bool reported = false, other = false;
  (*route)->handler(request, Caller{"anna", Role::kViewer, "127.0.0.1"}, [&](HttpResponse given) {
    EXPECT_EQ(given.status, 200u);
    reported = true;
  });
  database()->query<int>([](SqlConnection&) { return 1; },
                         [&](const tl::expected<int, DatabaseFault>&) {
                           EXPECT_FALSE(reported);
                           other = true;
                         });
  EXPECT_TRUE(io_.run_until([&] { return reported; }));
  EXPECT_TRUE(other);
}

TEST_F(ReportApiTest, RefusesWhatIsTooMuchOrInvalid) {
  store_hour();
  for (const char* query : {"by=week", "shifts=6", "format=xml", "by=month&from=9000d",
                            "by=shift&from=400d", "channel=a/b/c/d"})
    EXPECT_EQ(ask(std::string("/api/report?channel=line/meter/p&") + query).status, 400u) << query;
}

class SavedReportTest : public test::ApiTest {
 protected:
  SavedReportTest() {
    (void)open_store(address(), IfMissing::kCreate);
    add_routes(table_, {.database = database(), .now = now()});
  }
  HttpResponse post(const std::string& path, const Json& body, Role role = Role::kOperator) {
    HttpRequest request = test::request_of(path, Method::kPost);
    request.body = body.dump();
    return ask(request, role);
  }
};

TEST_F(SavedReportTest, AReportIsSavedReplacedAndDeleted) {
  const std::string save = "/api/reports/save";
  EXPECT_EQ(post(save, {{"name", "能耗"}, {"query", "c=line%2F*&by=day"}}).status, 200u);
  EXPECT_EQ(post(save, {{"name", "能耗"}, {"query", "c=line&by=month"}}).status, 200u);
  const Json saved = json("/api/reports").at("saved");
  ASSERT_EQ(saved.size(), 1u);
  EXPECT_EQ(saved.at(0).at("query"), "c=line&by=month");
  EXPECT_EQ(saved.at(0).at("saved_by"), "anna");
  EXPECT_EQ(post("/api/reports/delete", {{"name", "能耗"}}).status, 200u);
  EXPECT_EQ(post("/api/reports/delete", {{"name", "能耗"}}).status, 404u);
}

TEST_F(SavedReportTest, RefusesWhatIsNoNameAndNoQuery) {
  const std::string long_name(65, 'n'), long_query(4001, 'q');
  for (const Json& body :
       {Json{{"name", ""}, {"query", "c=a"}}, Json{{"name", long_name}, {"query", "c=a"}},
        Json{{"name", "a\nb"}, {"query", "c=a"}}, Json{{"name", "a"}, {"query", ""}},
        Json{{"name", "a"}, {"query", "<script>"}}, Json{{"name", "a"}, {"query", "c=a#b"}},
        Json{{"name", "a"}, {"query", long_query}}, Json{{"name", "a"}},
        Json{{"name", "a"}, {"query", "c=a"}, {"to", "/etc"}}})
    EXPECT_EQ(post("/api/reports/save", body).status, 400u) << body;
  EXPECT_EQ(post("/api/reports/save", {{"name", "a"}, {"query", "c=a"}}, Role::kViewer).status,
            403u);
}

TEST_F(SavedReportTest, ThereAreAtMostSoMany) {
  auto connection = open_store(address(), IfMissing::kFail);
  for (std::size_t i = 0; i < SavedReportTable::kMaxReports; ++i)
    EXPECT_TRUE(
        SavedReportTable(*connection).save({"r" + std::to_string(i), "c=a", "anna", utc(1)}));
  EXPECT_EQ(post("/api/reports/save", {{"name", "more"}, {"query", "c=a"}}).status, 409u);
  EXPECT_EQ(post("/api/reports/save", {{"name", "r7"}, {"query", "c=b"}}).status, 200u);
}

}  // namespace
}  // namespace fieldcast::web

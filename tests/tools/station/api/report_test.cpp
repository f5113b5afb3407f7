#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

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

TEST_F(ReportApiTest, RefusesWhatIsTooMuchOrInvalid) {
  store_hour();
  for (const char* query : {"by=week", "shifts=6", "format=xml", "by=month&from=9000d",
                            "by=shift&from=400d", "channel=line/meter/p"})
    EXPECT_EQ(ask(std::string("/api/report?channel=line/meter/p&") + query).status, 400u) << query;
}

}  // namespace
}  // namespace fieldcast::web

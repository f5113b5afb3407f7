#include "tools/station/api/history.hpp"

#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::Json;
using test::utc;

std::string ms(std::int64_t second) { return std::to_string(utc(second).nanoseconds / 1'000'000); }

class HistoryApiTest : public test::ApiTest {
 protected:
  void store_seconds(std::int64_t seconds, const std::function<bool(std::int64_t)>& skip = {}) {
    store([&](Store& to) {
      const auto number = to.number_of(
          {.bus = "line", .device = "press", .channel = "t", .unit = "bar", .type = "float64"});
      for (std::int64_t second = 0; second < seconds; ++second) {
        if (skip && skip(second)) continue;
        const SampleRow row{.channel = *number,
                            .published_at = utc(second),
                            .acquired_at = utc(second),
                            .sequence = static_cast<std::uint64_t>(second) + 1,
                            .quality = Quality::kGood,
                            .value = static_cast<double>(second)};
        to.put(std::span(&row, 1));
      }
    });
    add_routes(table_, {.database = database(), .now = now()});
  }
  [[nodiscard]] Json series(const std::string& query) {
    return json("/api/history?channel=line/press/t&" + query).at("series").at(0);
  }
};

TEST_F(HistoryApiTest, FewSamplesAreGivenAsTheyAre) {
  store_seconds(3);
  const Json found = series("from=" + ms(1) + "&to=" + ms(10));
  EXPECT_EQ(found.at("channel"), "line/press/t");
  EXPECT_EQ(found.at("unit"), "bar");
  EXPECT_EQ(found.at("type"), "float64");
  EXPECT_EQ(found.at("tier"), "raw");
  EXPECT_EQ(found.at("bucket_ms"), 0);
  EXPECT_EQ(found.at("t").dump(), "[" + ms(1) + "," + ms(2) + "]");
  EXPECT_EQ(found.at("min").dump(), "[1,2]");
  EXPECT_EQ(found.at("last").dump(), "[1,2]");
}

TEST_F(HistoryApiTest, ManySamplesBecomeBucketsWithMinMaxAndAverage) {
  store_seconds(100);
  const Json found = series("from=" + ms(0) + "&to=" + ms(100) + "&points=11");
  EXPECT_EQ(found.at("bucket_ms"), 10'000);
  EXPECT_EQ(found.at("min").dump(), "[0,10,20,30,40,50,60,70,80,90]");
  EXPECT_EQ(found.at("max").dump(), "[9,19,29,39,49,59,69,79,89,99]");
  EXPECT_EQ(found.at("average").at(0), 4.5);
  EXPECT_EQ(found.at("count").at(3), 10);
}

TEST_F(HistoryApiTest, AGapStaysAGap) {
  store_seconds(100, [](std::int64_t second) { return second >= 20 && second < 60; });
  const Json found = series("from=" + ms(0) + "&to=" + ms(100) + "&points=11");
  EXPECT_EQ(found.at("t").dump(), "[" + ms(0) + "," + ms(10) + "," + ms(60) + "," + ms(70) + "," +
                                      ms(80) + "," + ms(90) + "]");
}

TEST_F(HistoryApiTest, SamplesThatArrivedLateAreNamed) {
  store_seconds(100);
  const auto connection = open_store(address(), IfMissing::kCreate);
  LateTable table(*connection);
  table.add("line", "press", {utc(20), utc(30), 11, utc(95)});
  table.add("line", "other", {utc(20), utc(30), 1, utc(95)});
  EXPECT_EQ(series("from=" + ms(0) + "&to=" + ms(100)).at("late").dump(),
            "[{\"from_ms\":" + ms(20) + ",\"to_ms\":" + ms(30) +
                ",\"samples\":11,\"received_ms\":" + ms(95) + "}]");
  EXPECT_TRUE(series("from=" + ms(40) + "&to=" + ms(100)).at("late").empty());
}

TEST_F(HistoryApiTest, BadSamplesAreCountedAndGiveNoNumber) {
  store([](Store& to) {
    const auto number = to.number_of({.bus = "line", .device = "press", .channel = "t"});
    const SampleRow row{.channel = *number,
                        .published_at = utc(1),
                        .sequence = 1,
                        .quality = Quality::kBadNoResponse,
                        .value = 7.0};
    to.put(std::span(&row, 1));
  });
  add_routes(table_, {.database = database(), .now = now()});
  const Json found = series("from=" + ms(0) + "&to=" + ms(10));
  EXPECT_EQ(found.at("min").dump(), "[null]");
  EXPECT_EQ(found.at("average").dump(), "[null]");
  EXPECT_EQ(found.at("bad").dump(), "[1]");
  EXPECT_EQ(found.at("count").dump(), "[0]");
}

TEST_F(HistoryApiTest, TextsAreGivenAsTexts) {
  store([](Store& to) {
    const auto number =
        to.number_of({.bus = "line", .device = "press", .channel = "t", .type = "string"});
    const SampleRow row{.channel = *number,
                        .published_at = utc(1),
                        .sequence = 1,
                        .quality = Quality::kGood,
                        .value = std::string("run \"2\"")};
    to.put(std::span(&row, 1));
  });
  add_routes(table_, {.database = database(), .now = now()});
  const Json found = series("from=" + ms(0) + "&to=" + ms(10));
  EXPECT_EQ(found.at("text").dump(), R"(["run \"2\""])");
  EXPECT_EQ(found.at("quality").dump(), R"(["GOOD"])");
  EXPECT_EQ(found.at("cut"), false);
}

TEST_F(HistoryApiTest, AChannelThatTheStoreDoesNotKnowIsReported) {
  store_seconds(1);
  const Json found = json("/api/history?channel=no/such/channel&from=" + ms(0)).at("series").at(0);
  EXPECT_EQ(found.at("known"), false);
  EXPECT_TRUE(found.at("t").empty());
}

TEST_F(HistoryApiTest, EightChannelsAtMost) {
  store_seconds(1);
  std::string target = "/api/history?channel=a/b/c0";
  for (int i = 1; i < 9; ++i) target += "&channel=a/b/c" + std::to_string(i);
  EXPECT_EQ(ask(target).status, 400u);
}

TEST_F(HistoryApiTest, WithoutAStoreThereIsNone) {
  add_routes(table_, {.now = now()});
  const HttpResponse response = ask("/api/history?channel=a/b/c");
  EXPECT_EQ(response.status, 404u);
  EXPECT_NE(response.body.find("stores nothing"), std::string::npos);
}

TEST_F(HistoryApiTest, ALongResponseIsCompressedForWhoTakesIt) {
  store_seconds(1000);
  HttpRequest request =
      test::request_of("/api/history?channel=line/press/t&from=" + ms(0) + "&to=" + ms(1000));
  const std::string plain = ask(request).body;
  request.accepts_gzip = true;
  const HttpResponse zipped = ask(request);
  EXPECT_EQ(zipped.headers.at(0).second, "gzip");
  EXPECT_LT(zipped.body.size(), plain.size() / 3);
  EXPECT_EQ(test::unzipped(zipped.body), plain);
}

}  // namespace
}  // namespace fieldcast::web

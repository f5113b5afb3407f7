#include "tools/station/api/export.hpp"

#include <algorithm>

#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::utc;

class ExportApiTest : public test::ApiTest {
 protected:
  void store_samples(int channels, int samples) {
    store([&](Store& to) {
      for (int i = 0; i < channels; ++i) {
        const auto number = to.number_of(
            {.bus = "line", .device = "d", .channel = "c" + std::to_string(i), .type = "float64"});
        for (int second = 0; second < samples; ++second) {
          const SampleRow row{.channel = *number,
                              .published_at = utc(second),
                              .acquired_at = utc(second),
                              .sequence = static_cast<std::uint64_t>(second) + 1,
                              .quality = Quality::kGood,
                              .value = second + 0.5};
          to.put(std::span(&row, 1));
        }
      }
    });
    add_routes(table_, {.database = database(), .now = now()});
  }
  static std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      lines.push_back(text.substr(at, end - at));
      at = end == std::string::npos ? text.size() : end + 1;
    }
    return lines;
  }
};

TEST_F(ExportApiTest, EverySampleIsOneLineInTheOrderOfTheHistory) {
  store_samples(3, 5000);
  const HttpResponse response = ask("/api/export?pattern=line&from=0&to=1700009000000");
  EXPECT_EQ(response.content_type, "text/csv; charset=utf-8");
  const auto [body, pieces] = all_of(response);
  const auto lines = lines_of(body);
  ASSERT_EQ(lines.size(), 15'001u);
  EXPECT_EQ(lines[0], "published_at,acquired_at,bus,device,channel,value,unit,quality");
  EXPECT_EQ(lines[1], "2023-11-14T22:13:20.000Z,2023-11-14T22:13:20.000Z,line,d,c0,0.5,,GOOD");
  EXPECT_EQ(lines[15'000],
            "2023-11-14T23:36:39.000Z,2023-11-14T23:36:39.000Z,line,d,c2,4999.5,,GOOD");
  EXPECT_TRUE(std::is_sorted(lines.begin() + 1, lines.begin() + 5001));
  EXPECT_GT(pieces, 5) << "it is not held whole";
}

TEST_F(ExportApiTest, SamplesOfOneInstantAreNeitherLostNorReportedTwiceBetweenParts) {
  store([](Store& to) {
    const auto number = to.number_of({.bus = "line", .device = "d", .channel = "c"});
    for (std::uint64_t sequence = 1; sequence <= 6000; ++sequence) {
      const SampleRow row{.channel = *number,
                          .published_at = utc(static_cast<std::int64_t>(sequence / 1500)),
                          .sequence = sequence,
                          .quality = Quality::kGood,
                          .value = static_cast<double>(sequence)};
      to.put(std::span(&row, 1));
    }
  });
  add_routes(table_, {.database = database(), .now = now()});
  const auto lines =
      lines_of(all_of(ask("/api/export?format=jsonl&from=0&to=1700009000000")).first);
  ASSERT_EQ(lines.size(), 6000u);
  for (std::size_t i = 0; i < lines.size(); ++i)
    ASSERT_EQ(test::Json::parse(lines[i]).at("sequence"), i + 1);
}

TEST_F(ExportApiTest, CompressedItIsTheSameText) {
  store_samples(2, 3000);
  HttpRequest request = test::request_of("/api/export?from=0&to=1700009000000");
  const std::string plain = all_of(ask(request)).first;
  request.accepts_gzip = true;
  const HttpResponse zipped = ask(request);
  const std::string body = all_of(zipped).first;
  EXPECT_LT(body.size(), plain.size() / 4);
  EXPECT_EQ(test::unzipped(body), plain);
}

TEST_F(ExportApiTest, BucketsAreReportedWholeAndOnce) {
  store_samples(1, 4000);
  const auto lines = lines_of(
      all_of(ask("/api/export?every=1s&format=jsonl&from=1700000000500&to=1700009000000")).first);
  ASSERT_EQ(lines.size(), 4000u);
  EXPECT_EQ(test::Json::parse(lines[0]).at("time"), utc(0).nanoseconds);
  EXPECT_EQ(test::Json::parse(lines[3999]).at("count"), 1);
}

TEST_F(ExportApiTest, NamedChannelsAreOneFileNamedAfterThem) {
  store_samples(3, 2);
  const HttpResponse response =
      ask("/api/export?channel=line/d/c2&channel=line/d/c0&from=0&to=1700009000000");
  const auto lines = lines_of(all_of(response).first);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_NE(lines[1].find(",line,d,c2,0.5"), std::string::npos) << lines[1];
  EXPECT_NE(lines[4].find(",line,d,c0,1.5"), std::string::npos) << lines[4];
  EXPECT_EQ(std::ranges::find(response.headers, "content-disposition",
                              [](const auto& header) { return header.first; })
                ->second,
            "attachment; filename=\"line_d_c2+c0.csv\"");
  EXPECT_EQ(lines_of(all_of(ask("/api/export?channel=line/d/none&from=0")).first).size(), 1u);
  EXPECT_EQ(ask("/api/export?channel=c2").status, 400u);
}

TEST(ExportFileName, HasNoCharacterThatIsSpecialInAFileSystemAndABoundedLength) {
  ExportQuestion question;
  EXPECT_EQ(export_file_name(question), "history.csv");
  question.channels = {{"a", "b", "../x \"1\""}, {"a", "c", "y"}};
  question.json_lines = true;
  EXPECT_EQ(export_file_name(question), "a_b_.._x__1_+a_c_y.jsonl");
  question.channels.assign(8, {std::string(40, 'b'), "d", "c"});
  EXPECT_LE(export_file_name(question).size(), 130u);
}

TEST_F(ExportApiTest, NothingIsJustTheHeadLine) {
  store_samples(1, 1);
  EXPECT_EQ(lines_of(all_of(ask("/api/export?pattern=none&from=0")).first).size(), 1u);
  EXPECT_EQ(all_of(ask("/api/export?pattern=none&format=jsonl&from=0")).first, "");
}

TEST_F(ExportApiTest, OneTooManyIsRefusedUntilAnotherHasEnded) {
  store_samples(1, 1);
  std::vector<HttpResponse> running;
  const auto status_of = [&](const char* user) {
    HttpResponse response = ask(test::request_of("/api/export?from=0"), Role::kViewer, user);
    const unsigned status = response.status;
    if (status == 200) running.push_back(std::move(response));
    return status;
  };
  for (std::size_t i = 0; i < RunningExports::kMaxOfUser; ++i) EXPECT_EQ(status_of("anna"), 200u);
  EXPECT_EQ(status_of("anna"), 503u);
  for (std::size_t i = running.size(); i < RunningExports::kMax; ++i)
    EXPECT_EQ(status_of("bert"), 200u) << "the exports of anna leave room";
  EXPECT_EQ(status_of("carl"), 503u);
  running.erase(running.begin());
  EXPECT_EQ(status_of("bert"), 503u);
  EXPECT_EQ(status_of("carl"), 200u);
}

TEST_F(ExportApiTest, AClientThatLeavesInTheMiddleIsNotAFault) {
  store_samples(3, 5000);
  for (int i = 0; i < 20; ++i) {
    std::optional<HttpResponse> response = ask("/api/export?from=0&to=1700009000000");
    ASSERT_EQ(response->status, 200u);
    bool came = false;
    response->next([&](Piece) { came = true; });
    if (i % 2 == 0) response.reset();
    ASSERT_TRUE(io_.run_until([&] { return came; }));
  }
  database_.reset();
}

TEST_F(ExportApiTest, AStoreThatBreaksOffSaysSoInTheLastLine) {
  add_routes(table_, {.database = database(), .now = now()});
  const HttpResponse response = ask("/api/export?from=0");
  EXPECT_EQ(all_of(response).first, "incomplete: the database does not respond\n");
}

}  // namespace
}  // namespace fieldcast::web

#include "tools/cli/command/station/history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "bridge/store/tiers/tier_writer.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

UtcTime utc(std::int64_t second) { return {(1'699'999'200 + second) * 1'000'000'000}; }
constexpr std::int64_t kSpan = 4 * 3600;  // a sample every ten seconds

class HistoryTest : public testing::Test {
 protected:
  HistoryTest() {
    options_.pattern = *Pattern::parse("line/press/t");
    options_.source.store = scratch_.path("a.db");
    options_.span = {utc(0), utc(kSpan)};
    connection_ = open_store(StoreAddress(options_.source.store), IfMissing::kCreate);
    SampleTable samples(*connection_);
    id_ = samples.channel_id("line", "press", "t", "°C", "float32");
    std::vector<SampleRow> rows;
    for (std::int64_t second = 0; second < kSpan; second += 10) {
      rows.push_back({.channel = id_,
                      .published_at = utc(second),
                      .quality = Quality::kGood,
                      .value = static_cast<double>(second)});
    }
    TierWriter tiers;
    SqlTransaction transaction(*connection_);
    samples.insert(rows);
    tiers.note(*connection_, rows);
    transaction.commit();
    while (tiers.step(*connection_, utc(kSpan + 10))) {}
  }

  struct Printed {
    ExitCode code;
    std::string out, err;
    [[nodiscard]] std::ptrdiff_t lines() const { return std::ranges::count(out, '\n'); }
  };
  Printed run() const {
    std::istringstream in;
    std::ostringstream out, err;
    const ExitCode code = history(options_, Streams{in, out, err});
    return {code, out.str(), err.str()};
  }
  void remove_samples() {
    SampleTable(*connection_).remove_before(id_, utc(kSpan - 3600), 100'000);
  }

  const test::Scratch scratch_;
  std::unique_ptr<SqlConnection> connection_;
  std::int64_t id_ = 0;
  HistoryOptions options_;
};

TEST_F(HistoryTest, ByTheHourHasALineForEachUnderAHead) {
  options_.every = 1h;
  const Printed printed = run();
  EXPECT_EQ(printed.code, ExitCode::kOk);
  EXPECT_EQ(printed.lines(), 5);
  EXPECT_THAT(printed.out, StartsWith("time "));
  EXPECT_THAT(printed.out, HasSubstr("\n2023-11-14T23:00:00.000Z          3600          7190"
                                     "          5395     360      0  line/press/t (°C)\n"));
  EXPECT_EQ(printed.err, "");
}

TEST_F(HistoryTest, HasNoMorePointsThanAreWanted) {
  options_.points = 100;
  options_.json = true;
  const Printed printed = run();
  EXPECT_EQ(printed.lines(), 80) << "of three minutes each";
  EXPECT_THAT(printed.out, HasSubstr("\"count\":18,\"bad\":0}"));
}

TEST_F(HistoryTest, SaysWhereACoarserTierGoesBackFurther) {
  remove_samples();
  const Printed samples = run();
  EXPECT_EQ(samples.code, ExitCode::kOk);
  EXPECT_EQ(samples.lines(), 360);
  EXPECT_EQ(samples.err,
            "line/press/t: this goes back to 2023-11-15T01:00:00.000Z; each minute is kept from "
            "2023-11-14T22:00:00.000Z on: --every 1min\n");
  options_.span.from = utc(kSpan - 3600);
  EXPECT_EQ(run().err, "") << "all that was asked for is there";
  options_.span.from = utc(0);
  options_.every = 1min;
  options_.csv = true;
  const Printed minutes = run();
  EXPECT_EQ(minutes.lines(), 241);
  EXPECT_EQ(minutes.err, "");
}

TEST_F(HistoryTest, SaysSoWhenOnlyACoarserTierIsLeft) {
  remove_samples();
  options_.span.to = utc(600);
  const Printed printed = run();
  EXPECT_EQ(printed.code, ExitCode::kNothing);
  EXPECT_THAT(printed.err, HasSubstr("--every 1min\nnothing was stored of line/press/t"));
}

std::string unpacked(const std::string& path) {
  std::string text(1 << 20, '\0');
  const gzFile file = ::gzopen(path.c_str(), "rb");
  const int size = ::gzread(file, text.data(), static_cast<unsigned>(text.size()));
  ::gzclose(file);
  text.resize(static_cast<std::size_t>(std::max(size, 0)));
  return text;
}

TEST_F(HistoryTest, IsWrittenCompressedIntoANewFile) {
  options_.csv = true;
  const std::string wanted = run().out;
  options_.gzip = scratch_.path("t.csv.gz");
  const Printed packed = run();
  EXPECT_EQ(packed.code, ExitCode::kOk);
  EXPECT_EQ(packed.out, "");
  EXPECT_EQ(unpacked(options_.gzip), wanted);
  EXPECT_LT(std::filesystem::file_size(options_.gzip), wanted.size() / 5);
  for (const std::string& path :
       {options_.gzip, scratch_.path("none/t.gz"), options_.source.store}) {
    options_.gzip = path;
    const Printed refused = run();
    EXPECT_EQ(refused.code, ExitCode::kTrouble) << path;
    EXPECT_THAT(refused.err, HasSubstr(path + " cannot be written: ")) << "it is there already";
  }
}

}  // namespace
}  // namespace fieldcast::cli

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <optional>

#include "tests/support/text_cases.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {
namespace {

using testing::ElementsAre;

const UtcTime kNow{1'700'000'000'123'456'789};  // 2023-11-14T22:13:20Z

std::string parsed(std::string_view text) {
  const auto time = parse_time(text, kNow);
  return time ? utc_text(*time) : "no time";
}

TEST(TimeText, DatesAndTimesAreUtc) {
  test::expect_texts(parsed, {"2026-11-21 -> 2026-11-21T00:00:00.000Z",
                              "2024-02-29T23:59 -> 2024-02-29T23:59:00.000Z",
                              "2026-11-21 10:30:05 -> 2026-11-21T10:30:05.000Z",
                              "2026-11-21T10:30:05.25Z -> 2026-11-21T10:30:05.250Z"});
  EXPECT_EQ(parse_time("1970-01-01T00:00:00.000000001", kNow)->nanoseconds, 1);
}

TEST(TimeText, AnOffsetIsTakenOff) {
  test::expect_texts(parsed,
                     {"2026-11-21T10:30+01:00 -> 2026-11-21T09:30:00.000Z",
                      "2026-11-21 10:30:05.25-03:30 -> 2026-11-21T14:00:05.250Z",
                      "2026-11-21T10:30+01 -> no time", "2026-11-21T10:30+01:00Z -> no time"});
}

class ZoneOfProcess {
 public:
  explicit ZoneOfProcess(const char* name) {
    if (const char* before = ::getenv("TZ")) before_ = before;
    ::setenv("TZ", name, 1);
    ::tzset();
  }
  ~ZoneOfProcess() {
    if (before_)
      ::setenv("TZ", before_->c_str(), 1);
    else
      ::unsetenv("TZ");
    ::tzset();
  }
  ZoneOfProcess(const ZoneOfProcess&) = delete;
  ZoneOfProcess& operator=(const ZoneOfProcess&) = delete;

 private:
  std::optional<std::string> before_;
};

TEST(TimeText, LocalTimesSayHowFarTheyAreFromUtc) {
  const auto local = [](const char* zone) {
    const ZoneOfProcess there(zone);
    return time_text(kNow, Zone::kLocal);
  };
  EXPECT_EQ(time_text(kNow, Zone::kUtc), "2023-11-14T22:13:20.123Z");
  EXPECT_EQ(local("XXX-8"), "2023-11-15T06:13:20.123+08:00");
  EXPECT_EQ(local("XXX+3:30"), "2023-11-14T18:43:20.123-03:30");
  EXPECT_EQ(local("UTC0"), "2023-11-14T22:13:20.123+00:00");
  EXPECT_EQ(parsed(local("XXX-8")), "2023-11-14T22:13:20.123Z") << "it can be given back";
  EXPECT_EQ(time_text(UtcTime{}, Zone::kLocal), "-");
}

TEST(TimeText, DurationsAreSoLongAgo) {
  test::expect_texts(parsed, {"now -> 2023-11-14T22:13:20.123Z", "2h -> 2023-11-14T20:13:20.123Z",
                              "30min -> 2023-11-14T21:43:20.123Z",
                              "30m -> 2023-11-14T21:43:20.123Z", "3d -> 2023-11-11T22:13:20.123Z"});
}

TEST(TimeText, WhatIsNotATimeIsRefusedWithWhatIs) {
  for (const char* text :
       {"", "yesterday", "2026-13-01", "2026-02-30", "2026-11-21T", "2026-11-21T24:00",
        "2026-11-21T10", "10:30", "20", "2026-11-21T10:30:05.", "2026-11-21T10:30x", "1969-12-31",
        "9999-01-01", "-2h"}) {
    EXPECT_EQ(parsed(text), "no time") << text;
  }
  EXPECT_NE(parse_time("yesterday", kNow).error().find("'yesterday' is no time; write 2026-11-21"),
            std::string::npos);
}

TEST(Width, CountsCodePoints) {
  EXPECT_EQ(display_width("21.5 °C"), 7u);
  EXPECT_EQ(clip("°C/min", 2), "°C");
  EXPECT_EQ(clip("°C", 9), "°C");
}

TEST(Printable, ControlCharactersAreShownNotObeyed) {
  EXPECT_EQ(printable("\x1b[2Jgone\n"), "\\x1B[2Jgone\\n");
  EXPECT_EQ(printable("\xC2\x9B"
                      "2J"),
            "\\u009B2J");  // U+009B is the one-character form of ESC [
  EXPECT_EQ(printable("a\u202eb\u2066"), "a\\u202Eb\\u2066") << "marks that turn the direction";
  EXPECT_EQ(printable("°C"), "°C");
}

TEST(Table, ColumnsAreAsWideAsTheirLongestCell) {
  TextTable table({{"name"}, {"value", Align::kRight}, {"unit"}});
  table.add_row({{"oil"}, {"7"}, {"°C"}});
  table.add_row({{"pressure"}, {"12.25"}, {"bar"}});
  EXPECT_THAT(table.render({}), ElementsAre("name      value  unit",  //
                                            "oil           7  °C",    //
                                            "pressure  12.25  bar"));
}

TEST(Table, IsCutAtTheScreensWidth) {
  TextTable table({{"name"}, {"value", Align::kRight}, {"unit"}});
  table.add_row({{"pressure"}, {"12.25"}, {"bar"}});
  for (std::size_t columns = 1; columns < 40; ++columns) {
    for (const auto& line : table.render({columns, 0, false}))
      EXPECT_LE(display_width(line), columns);
  }
  EXPECT_THAT(table.render({12, 0, false}), ElementsAre("name      va", "pressure  12"));
}

TEST(Table, ColoursEndInTheirCell) {
  TextTable table({{"quality"}});
  table.add_row({{"GOOD", Tone::kGood}});
  EXPECT_THAT(table.render({0, 0, true}),
              ElementsAre("\x1b[1mquality\x1b[0m", "\x1b[32mGOOD\x1b[0m"));
}

TEST(Table, MissingCellsAreEmpty) {
  TextTable table({{"a"}, {"b"}});
  table.add_row({{"x"}});
  EXPECT_THAT(table.render({}), ElementsAre("a  b", "x"));
}

}  // namespace
}  // namespace fieldcast::cli

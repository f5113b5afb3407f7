#include "tools/station/notify/hours.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <ctime>

namespace fieldcast::web {
namespace {

constexpr int kMonday = 0, kFriday = 4, kSaturday = 5, kSunday = 6;

LocalMinute at(int day, int hour, int minute = 0) { return {day, 60 * hour + minute}; }

bool contains(std::string_view hours, const LocalMinute& time) {
  const auto span = hours_from(hours);
  EXPECT_TRUE(span) << hours;
  return span && span->contains(time);
}

TEST(Hours, EndIsNotPartOfTheSpan) {
  EXPECT_FALSE(contains("08:00-17:00", at(kMonday, 7, 59)));
  EXPECT_TRUE(contains("08:00-17:00", at(kMonday, 8)));
  EXPECT_TRUE(contains("08:00-17:00", at(kSunday, 16, 59)));
  EXPECT_FALSE(contains("08:00-17:00", at(kMonday, 17)));
  EXPECT_TRUE(contains("08:00-24:00", at(kMonday, 23, 59)));
}

TEST(Hours, ANightBelongsToTheDayOnWhichItBegins) {
  EXPECT_TRUE(contains("mon-fri 18:00-06:00", at(kFriday, 23)));
  EXPECT_TRUE(contains("mon-fri 18:00-06:00", at(kSaturday, 5, 59)));
  EXPECT_FALSE(contains("mon-fri 18:00-06:00", at(kSaturday, 6)));
  EXPECT_FALSE(contains("mon-fri 18:00-06:00", at(kSaturday, 23)));
  EXPECT_FALSE(contains("mon-fri 18:00-06:00", at(kMonday, 5)));
  EXPECT_TRUE(contains("sun 18:00-06:00", at(kMonday, 5)));
}

TEST(Hours, AreWrittenAsTheyAreRead) {
  for (const char* text : {"mon-fri 18:00-06:00", "sat-sun", "08:00-17:00", "fri-mon", "sun",
                           "wed 08:30-24:00", "mon-sun"})
    EXPECT_EQ(to_text(*hours_from(text)), text);
  EXPECT_EQ(to_text(*hours_from("mon-sun 08:00-17:00")), "08:00-17:00");
}

TEST(Hours, DaysMayWrapAndStandAlone) {
  EXPECT_TRUE(contains("sat-sun", at(kSunday, 0)));
  EXPECT_FALSE(contains("sat-sun", at(kMonday, 0)));
  EXPECT_TRUE(contains("fri-mon", at(kMonday, 12)));
  EXPECT_FALSE(contains("fri-mon", at(3, 12)));
  EXPECT_TRUE(contains("06:00-06:00", at(kMonday, 3)));  // the whole day
}

TEST(Hours, OtherTextsAreInvalid) {
  for (const char* text : {"", " ", "monday", "mon-", "8:00-17:00", "08:00", "08:00-25:00",
                           "24:00-06:00", "08:60-09:00", "mon 08:00", "mon  08:00-09:00",
                           "08:00-09:00 mon", "0x:00-09:00", "mon-fri 18:00-06:00 "})
    EXPECT_FALSE(hours_from(text)) << text;
}

TEST(Hours, WithoutSpansEveryTimeFits) {
  EXPECT_TRUE(in_hours({}, at(kMonday, 3)));
  const HoursSpan spans[] = {*hours_from("sat-sun"), *hours_from("mon-fri 18:00-06:00")};
  EXPECT_TRUE(in_hours(spans, at(kSunday, 12)));
  EXPECT_FALSE(in_hours(spans, at(kMonday, 12)));
}

class Zone {
 public:
  explicit Zone(const char* name) {
    if (const char* before = std::getenv("TZ")) before_ = before;
    ::setenv("TZ", name, 1);
    ::tzset();
  }
  ~Zone() {
    before_.empty() ? ::unsetenv("TZ") : ::setenv("TZ", before_.c_str(), 1);
    ::tzset();
  }
  Zone(const Zone&) = delete;
  Zone& operator=(const Zone&) = delete;

 private:
  std::string before_;
};

LocalMinute local(std::int64_t unix_seconds) {
  return local_minute({unix_seconds * 1'000'000'000});
}

TEST(Hours, FollowTheWallClockOverDaylightSaving) {
  // As a rule of POSIX, so that no database of zones is needed: Central Europe.
  const Zone zone("CET-1CEST,M3.5.0,M10.5.0/3");
  const auto night = *hours_from("sat 22:00-06:00");
  // 2026-03-29 01:00 UTC: 02:00 becomes 03:00. The night ends at 06:00 CEST, 04:00 UTC.
  constexpr std::int64_t kSpring = 1'774'746'000;
  EXPECT_EQ(local(kSpring - 60).minute, 119);
  EXPECT_EQ(local(kSpring).minute, 180);
  EXPECT_EQ(local(kSpring).weekday, kSunday);
  EXPECT_TRUE(night.contains(local(kSpring + 3 * 3600 - 60)));
  EXPECT_FALSE(night.contains(local(kSpring + 3 * 3600)));
  // 2026-10-25 01:00 UTC: 03:00 becomes 02:00. The night ends at 06:00 CET, 05:00 UTC.
  constexpr std::int64_t kAutumn = 1'792'890'000;
  EXPECT_EQ(local(kAutumn - 60).minute, 179);
  EXPECT_EQ(local(kAutumn).minute, 120);
  EXPECT_TRUE(night.contains(local(kAutumn + 4 * 3600 - 60)));
  EXPECT_FALSE(night.contains(local(kAutumn + 4 * 3600)));
}

}  // namespace
}  // namespace fieldcast::web

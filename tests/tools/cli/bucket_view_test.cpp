#include <gtest/gtest.h>

#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {
namespace {

const StoredChannel kChannel{1, "press-shop", "press-1", "oil", "°C", "float32"};
const Bucket kMinute{1,  {1'699'999'980'000'000'000}, 3, 1, static_cast<double>(0.1f), 2, 4.1, 1,
                     0.5};
const Bucket kNothingGood{.channel = 1, .start = kMinute.start, .bad = 60};

TEST(BucketView, TellsPeopleWhatAStretchOfTimeWas) {
  EXPECT_EQ(bucket_head(Zone::kUtc),
            "time                               min           max       average   count    bad  "
            "channel");
  EXPECT_EQ(bucket_line(kChannel, kMinute, Zone::kUtc),
            "2023-11-14T22:13:00.000Z           0.1             2      1.366667       3      1  "
            "press-shop/press-1/oil (°C)");
  EXPECT_EQ(bucket_line(kChannel, kNothingGood, Zone::kUtc),
            "2023-11-14T22:13:00.000Z             -             -             -       0     60  "
            "press-shop/press-1/oil (°C)");
}

TEST(BucketView, CsvHasEveryDigitAndNothingWhereNothingWasGood) {
  EXPECT_EQ(bucket_csv_head(), "time,min,max,average,count,bad,bus,device,channel,unit");
  EXPECT_EQ(bucket_csv(kChannel, kMinute, Zone::kUtc),
            "2023-11-14T22:13:00.000Z,0.1,2,1.3666666666666665,3,1,press-shop,press-1,oil,°C");
  EXPECT_EQ(bucket_csv(kChannel, kNothingGood, Zone::kUtc),
            "2023-11-14T22:13:00.000Z,,,,0,60,press-shop,press-1,oil,°C");
}

TEST(BucketView, JsonHasNullWhereNothingWasGood) {
  EXPECT_EQ(bucket_json(kChannel, kNothingGood).text(),
            R"({"bus":"press-shop","device":"press-1","channel":"oil","time":1699999980000000000,)"
            R"("min":null,"max":null,"average":null,"count":0,"bad":60})");
  EXPECT_EQ(parsed(bucket_json(kChannel, kMinute))["max"], 2.0);
}

}  // namespace
}  // namespace fieldcast::cli

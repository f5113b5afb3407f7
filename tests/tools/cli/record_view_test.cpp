#include "tools/cli/view/record_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/csv_field.hpp"
#include "tests/tools/cli/parsed_json.hpp"

namespace fieldcast::cli {
namespace {

using testing::HasSubstr;

const UtcTime kAt{1'700'000'000'000'000'000};

StoredSample sample(Value value) {
  return {.bus = "press-shop",
          .device = "press-1",
          .channel = "oil",
          .unit = "°C",
          .published_at = {kAt.nanoseconds + 5'000'000},
          .acquired_at = kAt,
          .sequence = 7,
          .quality = Quality::kGood,
          .value = std::move(value)};
}

TEST(RecordView, ASampleHasTheFieldsOfItsTopicAndWhenItWasPublished) {
  EXPECT_EQ(
      record_json(sample(21.5)).text(),
      R"({"bus":"press-shop","device":"press-1","channel":"oil","value":21.5,"quality":"GOOD",)"
      R"("acquired_at":1700000000000000000,"sequence":7,"published_at":1700000000005000000})");
  StoredSample never = sample(0.0);
  never.acquired_at = {};
  EXPECT_TRUE(parsed(record_json(never))["value"].is_null());
}

TEST(RecordView, UsersSeeTheAgeOfAValueThatIsPublishedAgain) {
  EXPECT_EQ(history_line(sample(21.5)),
            "2023-11-14T22:13:20.005Z  press-shop/press-1/oil  21.5 °C  GOOD");
  StoredSample stale = sample(21.5);
  stale.quality = Quality::kBadNoResponse;
  EXPECT_THAT(history_line(stale), HasSubstr("BAD_NO_ANSWER (of 2023-11-14T22:13:20.000Z)"));
  EXPECT_THAT(history_line(sample(std::string("a\nb\x1b[2J"))), HasSubstr("a\\nb\\x1B[2J"));
}

TEST(RecordView, CsvQuotesWhatWouldBreakIt) {
  EXPECT_EQ(history_csv_head(), "published_at,acquired_at,bus,device,channel,value,unit,quality");
  EXPECT_EQ(history_csv(sample(std::string("say \"a,b\"\n"))),
            "2023-11-14T22:13:20.005Z,2023-11-14T22:13:20.000Z,press-shop,press-1,oil,\"say "
            "\"\"a,b\"\"\\n\",°C,GOOD");
  StoredSample never = sample(0.0);
  never.acquired_at = {};
  EXPECT_EQ(history_csv(never), "2023-11-14T22:13:20.005Z,,press-shop,press-1,oil,,°C,GOOD");
}

TEST(RecordView, CsvTextIsNeverAFormula) {
  for (const std::string text : {"=1+1", "+1", "-1", "@SUM(1)"}) {
    EXPECT_EQ(csv_field(text), "'" + text);
    EXPECT_THAT(history_csv(sample(text)), HasSubstr(",oil,'" + text + ","));
  }
  EXPECT_EQ(csv_field("\t=1"), "'\\t=1");
  EXPECT_EQ(csv_field("\r=1"), "'\\r=1");
  EXPECT_EQ(csv_field("=A1,\"b\""), "\"'=A1,\"\"b\"\"\"");
  EXPECT_EQ(csv_field("a=1"), "a=1");
  EXPECT_THAT(history_csv(sample(-21.5)), HasSubstr(",oil,-21.5,"));
}

TEST(RecordView, NumbersKeepEveryDigitOfTheirType) {
  const auto value_of = [](double number, const std::string& type) {
    StoredSample stored = sample(number);
    stored.type = type;
    const std::string csv = history_csv(stored);
    const std::size_t begin = csv.find("oil,") + 4;
    const std::string value = csv.substr(begin, csv.find(',', begin) - begin);
    EXPECT_THAT(history_line(stored), HasSubstr("  " + value + " °C"));
    return value;
  };
  EXPECT_EQ(value_of(0.1 + 0.2, "float64"), "0.30000000000000004");
  EXPECT_EQ(value_of(1234567.8901234567, ""), "1234567.8901234567");
  EXPECT_EQ(value_of(static_cast<double>(41.7f), "float32"), "41.7");
  EXPECT_EQ(value_of(std::nan(""), "float64"), "nan");
  EXPECT_EQ(value_of(-std::numeric_limits<double>::infinity(), "float32"), "-inf");
}

TEST(RecordView, AuditSaysWhoWhatWhereHowMuchAndWhatBecameOfIt) {
  const AuditEntry entry{kAt,   "ann from 10.0.0.1", "program", "press-shop/press-1", 1000, 20,
                         "done"};
  EXPECT_EQ(audit_line(entry),
            "2023-11-14T22:13:20.000Z  ann from 10.0.0.1  program press-shop/press-1  1000 bytes "
            "to the device, 20 from it  done");
  EXPECT_EQ(parsed(record_json(entry))["bytes_to_device"], 1000);
  const auto command = parsed(
      record_json(AuditEntry{.at = kAt, .who = "panel", .what = "write 5", .result = "done"}));
  EXPECT_FALSE(command.contains("bytes_to_device"));  // it is not counted, which is not 0
  EXPECT_FALSE(command.contains("bytes_from_device"));
  EXPECT_EQ(audit_line({.at = kAt, .who = "eve\n", .what = "login", .result = "refused"}),
            "2023-11-14T22:13:20.000Z  eve\\n  login  refused");
}

TEST(RecordView, TablesNameDevicesAndUsers) {
  const auto devices = device_lines({{"b", "d", "modbus-rtu", "/dev/ttyS0, 1", "offline", kAt}},
                                    {kAt.nanoseconds + 90'000'000'000}, {});
  ASSERT_EQ(devices.size(), 2u);
  EXPECT_THAT(devices[1],
              testing::AllOf(HasSubstr("b/d"), HasSubstr("offline"), HasSubstr("1.50 min")));
  const auto users = user_lines({{"ann", Role::kProgrammer, kAt}}, {});
  EXPECT_THAT(users[1], testing::AllOf(HasSubstr("ann"), HasSubstr("programmer")));
  EXPECT_EQ(record_json(User{"ann", Role::kViewer, kAt}).text(),
            R"({"user":"ann","role":"viewer","created_at":1700000000000000000})");
}

}  // namespace
}  // namespace fieldcast::cli

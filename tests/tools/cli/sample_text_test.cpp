#include "tools/cli/model/sample_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "tests/tools/cli/parsed_json.hpp"

namespace fieldcast::cli {
namespace {

StationSample sample_of(Value value) {
  StationSample sample{"bus", "device", "channel", std::move(value), Quality::kGood};
  sample.acquired_at = UtcTime{1'700'000'000'123'456'789};
  sample.sequence = 7;
  return sample;
}

std::string json_value(Value value) {
  const std::string line = sample_json(sample_of(std::move(value))).text();
  const std::size_t begin = line.find("\"value\":") + 8;
  return line.substr(begin, line.rfind(",\"quality\"") - begin);
}

TEST(SampleJson, HasTheFieldsOfTheIdl) {
  EXPECT_EQ(sample_json(sample_of(true)).text(),
            R"({"bus":"bus","device":"device","channel":"channel","value":true,"quality":"GOOD",)"
            R"("acquired_at":1700000000123456789,"sequence":7})");
}

TEST(SampleJson, IntegersAreExactAndDoublesRoundTrip) {
  EXPECT_EQ(json_value(std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
  EXPECT_EQ(json_value(std::numeric_limits<std::uint64_t>::max()), "18446744073709551615");
  for (const double number : {0.1, 1e300, -5e-324, 1.0 / 3.0, 2.0})
    EXPECT_EQ(std::strtod(json_value(number).c_str(), nullptr), number);
}

TEST(SampleJson, MarksThatTurnTheDirectionAreEscaped) {
  for (const char* mark : {"\u202A", "\u202B", "\u202C", "\u202D", "\u202E", "\u2066", "\u2067",
                           "\u2068", "\u2069", "\u200E", "\u200F", "\u061C", "\u009B"}) {
    const std::string text = std::string("a") + mark + "°C";
    const std::string line = Json{{mark, text}}.text();
    EXPECT_EQ(line.find(mark), std::string::npos) << line;
    EXPECT_EQ(parsed(line)[mark], text) << "the same text for a program";
  }
  EXPECT_EQ(Json("\u202E").text(), R"("\u202e")");
  EXPECT_EQ(Json("\xff\"\\\n").text(), "\"\uFFFD\\\"\\\\\\n\"");
}

TEST(SampleJson, NoNumberIsNull) {
  EXPECT_EQ(json_value(std::nan("")), "null");
  EXPECT_EQ(json_value(std::numeric_limits<double>::infinity()), "null");
}

TEST(SampleJson, TextIsEscapedAndAlwaysUtf8) {
  EXPECT_EQ(json_value(std::string("a\"b\n")), R"("a\"b\n")");
  EXPECT_EQ(json_value(std::string("\xFF")), R"("\\xFF")");
}

TEST(SampleText, BytesThatAreNoTextAreShownInEveryOutput) {
  const auto sample = sample_of(std::string("K\xFChl\x1B[2J"));
  EXPECT_EQ(sample_line(sample, nullptr),
            "2023-11-14T22:13:20.123Z  bus/device/channel  K\\xFChl\\x1B[2J  GOOD");
  EXPECT_EQ(parsed(sample_json(sample))["value"].dump(), R"("K\\xFChl\\x1B[2J")");
}

TEST(SampleJson, ChannelThatWasNeverReadHasNoValue) {
  auto sample = sample_of(std::int64_t{0});
  sample.acquired_at = {};
  sample.quality = Quality::kNotYetRead;
  EXPECT_TRUE(parsed(sample_json(sample))["value"].is_null());
}

TEST(SampleJson, DevicesOwnCodeIsThereWhenItGaveOne) {
  auto sample = sample_of(true);
  EXPECT_FALSE(parsed(sample_json(sample)).contains("device_code"));
  sample.device_code = 2;
  EXPECT_EQ(parsed(sample_json(sample))["device_code"], 2);
  sample.quality = Quality::kBadDeviceError;
  EXPECT_EQ(quality_text(sample), "BAD_DEVICE_ERROR (code 02)");
  StationChannel about;
  about.at = "holding:100";
  EXPECT_EQ(quality_text(sample, &about), "BAD_DEVICE_ERROR (02 illegal data address)");
}

TEST(SampleText, RawValueThatMeansNoValueIsNamed) {
  auto sample = sample_of(true);
  sample.quality = Quality::kBadRange;
  EXPECT_EQ(quality_text(sample), "BAD_RANGE");
  sample.device_code = kNotAvailableCode;
  EXPECT_EQ(quality_text(sample), "BAD_RANGE (the device has no value)");
  sample.device_code = kNoResultCode;  // of a calculated channel
  EXPECT_EQ(quality_text(sample), "BAD_RANGE (no finite result)");
}

TEST(ValueForUsers, HasEveryDigitOfItsType) {
  EXPECT_EQ(value_text(static_cast<double>(0.1f), "float32"), "0.1");
  EXPECT_EQ(value_text(static_cast<double>(0.1f), "float64"), "0.10000000149011612");
  EXPECT_EQ(value_text(3.141592653589793, "float64"), "3.141592653589793");
  EXPECT_EQ(value_text(3.141592653589793, ""), "3.141592653589793");
  EXPECT_EQ(value_text(123456789012345.67, "float64"), "123456789012345.67");
  EXPECT_EQ(value_text(100000.0, "float32"), "100000");
  EXPECT_EQ(value_text(23.4, "uint16"), "23.4");
  EXPECT_EQ(value_text(std::uint64_t{18446744073709551615u}, "uint64"), "18446744073709551615");
}

TEST(Age, ChoosesItsUnit) {
  const auto age = [](double seconds) {
    return age_text(UtcTime{1'000'000'000}, UtcTime{1'000'000'000 + from_seconds(seconds).count()});
  };
  EXPECT_EQ(age(0.25), "0.25 s");
  EXPECT_EQ(age(42), "42 s");
  EXPECT_EQ(age(180), "3.00 min");
  EXPECT_EQ(age(36000), "10 h");
  EXPECT_EQ(age(-5), "0.00 s");  // the sender's clock is ahead
  EXPECT_EQ(age_text({}, UtcTime{1}), "-");
}

TEST(UtcSpelling, IsIso8601) {
  EXPECT_EQ(utc_text(UtcTime{1'700'000'000'123'456'789}), "2023-11-14T22:13:20.123Z");
  EXPECT_EQ(utc_text({}), "-");
}

TEST(SampleLine, NamesValueUnitAndQuality) {
  StationChannel about;
  about.type = "float32";
  about.unit = "°C";
  EXPECT_EQ(sample_line(sample_of(static_cast<double>(41.7f)), &about),
            "2023-11-14T22:13:20.123Z  bus/device/channel  41.7 °C  GOOD");
}

}  // namespace
}  // namespace fieldcast::cli

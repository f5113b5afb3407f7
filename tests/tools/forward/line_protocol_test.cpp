#include "tools/forward/outlet/influxdb/line_protocol.hpp"

#include <gmock/gmock.h>
#include <zlib.h>

#include <limits>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/influxdb/gzip.hpp"

namespace fieldcast::forward {
namespace {

using testing::HasSubstr;

std::string line_of(Value value, Quality quality = Quality::kGood) {
  SampleBatch batch;
  batch.bus = "line";
  batch.device = "press";
  batch.epoch = 7;
  BatchSample sample;
  sample.sequence = 3;
  sample.acquired_at = UtcTime{1'000'000'001};
  sample.value = std::move(value);
  sample.quality = quality;
  batch.samples.push_back(sample);
  return to_lines("north", batch, catalogue({"speed"}));
}

TEST(LineProtocol, ASampleIsOneLine) {
  EXPECT_EQ(line_of(2.5),
            "fieldcast,bus=line,channel=speed,device=press,quality=GOOD,site=north "
            "value=2.5,epoch=7i,sequence=3i 1000000001\n");
}

TEST(LineProtocol, EveryValueIsANumberIfItCanBe) {
  EXPECT_THAT(line_of(true), HasSubstr(" value=1,epoch"));
  EXPECT_THAT(line_of(std::int64_t{-4}), HasSubstr(" value=-4,epoch"));
  EXPECT_THAT(line_of(std::string("a \"b\"\\")), HasSubstr(R"( text="a \"b\"\\",epoch)"));
  EXPECT_THAT(line_of(std::numeric_limits<double>::quiet_NaN()), HasSubstr(" text=\"nan\",epoch"));
  EXPECT_THAT(line_of(std::numeric_limits<std::uint64_t>::max()),
              HasSubstr(",text=\"18446744073709551615\",epoch"));
}

TEST(LineProtocol, TheQualityIsATag) {
  EXPECT_THAT(line_of(2.5, Quality::kUncertain), HasSubstr(",quality=UNCERTAIN,"));
}

TEST(LineProtocol, AChannelBeyondTheCatalogueIsLeftOut) {
  EXPECT_EQ(to_lines("north", seconds(0, 3), catalogue({})), "");
}

TEST(LineProtocol, TagsAreEscaped) {
  EXPECT_EQ(escaped_tag("a b,c=d"), R"(a\ b\,c\=d)");
  EXPECT_EQ(escaped_tag("a\nb"), "a b");
  EXPECT_EQ(escaped_tag("a\\"), "a\\_");
  EXPECT_EQ(escaped_tag(""), "_");
}

TEST(LineProtocol, AnAlarmHasItsOwnMeasurement) {
  const std::string line = to_line("north", alarm());
  EXPECT_TRUE(line.starts_with("fieldcast_alarm,bus=")) << line;
  EXPECT_THAT(line, HasSubstr(",site=north active="));
  EXPECT_TRUE(line.ends_with("\n"));
}

TEST(Gzip, IsUncompressedByZlib) {
  const std::string text(100'000, 'x');
  const std::string packed = gzipped(text);
  EXPECT_LT(packed.size(), 1'000u);
  std::string unpacked(text.size(), '\0');
  z_stream stream{};
  ASSERT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(unpacked.data());
  stream.avail_out = static_cast<uInt>(unpacked.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  inflateEnd(&stream);
  EXPECT_EQ(unpacked, text);
}

}  // namespace
}  // namespace fieldcast::forward

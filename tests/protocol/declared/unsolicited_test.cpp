// Frames that devices send without a request.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/support/declared_device.hpp"

namespace fieldcast::test {
namespace {

// The items of each found frame as text, with a blank for unused characters:
// "fix: 123519 4807.038".
class Station {
 public:
  explicit Station(const std::string& protocol) : device_(declared_device(protocol, 1)) {}

  std::vector<std::string> hear(std::string_view text) {
    append(kept_, Bytes(text.begin(), text.end()));
    std::vector<std::string> frames;
    for (;;) {
      const UnsolicitedFrame found = device_.protocol().find_unsolicited(kept_, boundary_);
      EXPECT_LE(found.used, kept_.size());
      kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(found.used));
      boundary_ = found.boundary;
      if (!found.range) return frames;
      frames.push_back(text_of(*found.range, found.items));
    }
  }
  [[nodiscard]] std::size_t kept() const { return kept_.size(); }

 private:
  std::string text_of(const Range& range, ByteView items) const {
    EXPECT_EQ(items.size(), 2 * range.count);
    std::string text(device_.protocol().areas()[range.area].name);
    text += ':';
    bool blank = true;
    for (const std::uint8_t byte : items) {
      if (byte != 0) text += (blank ? " " : "") + std::string(1, static_cast<char>(byte));
      blank = byte == 0;
    }
    return text;
  }

  Device device_;
  Bytes kept_;
  bool boundary_ = false;
};

using Frames = std::vector<std::string>;

// Source: the library dsmr_parser, test/example_telegrams.py, TELEGRAM_V4_2.
TEST(DsmrP1, ReadsAPublishedTelegram) {
  Station meter("dsmr-p1");
  const std::string telegram =
      "/KFM5KAIFA-METER\r\n\r\n1-3:0.2.8(42)\r\n0-0:1.0.0(161113205757W)\r\n"
      "0-0:96.1.1(3960221976967177082151037881335713)\r\n1-0:1.8.1(001581.123*kWh)\r\n"
      "1-0:1.8.2(001435.706*kWh)\r\n1-0:2.8.1(000000.000*kWh)\r\n1-0:2.8.2(000000.000*kWh)\r\n"
      "0-0:96.14.0(0002)\r\n1-0:1.7.0(02.027*kW)\r\n1-0:2.7.0(00.000*kW)\r\n0-0:96.7.21(00015)\r\n"
      "0-0:96.7.9(00007)\r\n1-0:99.97.0(3)(0-0:96.7.19)(000104180320W)(0000237126*s)"
      "(000101000001W)(2147583646*s)(000102000003W)(2317482647*s)\r\n1-0:32.32.0(00000)\r\n"
      "1-0:52.32.0(00000)\r\n1-0:72.32.0(00000)\r\n1-0:32.36.0(00000)\r\n1-0:52.36.0(00000)\r\n"
      "1-0:72.36.0(00000)\r\n0-0:96.13.1()\r\n0-0:96.13.0()\r\n1-0:31.7.0(000*A)\r\n"
      "1-0:51.7.0(006*A)\r\n1-0:71.7.0(002*A)\r\n1-0:21.7.0(00.170*kW)\r\n1-0:22.7.0(00.000*kW)\r\n"
      "1-0:41.7.0(01.247*kW)\r\n1-0:42.7.0(00.000*kW)\r\n1-0:61.7.0(00.209*kW)\r\n"
      "1-0:62.7.0(00.000*kW)\r\n0-1:24.1.0(003)\r\n0-1:96.1.0(4819243993373755377509728609491464)"
      "\r\n"
      "0-1:24.2.1(161129200000W)(00981.443*m3)\r\n!6796\r\n";
  const auto frames = meter.hear(telegram);
  ASSERT_EQ(frames.size(), 1u);
  for (const char* value : {"001581.123", "001435.706", "02.027", "00981.443", "0002"})
    EXPECT_NE(frames[0].find(value), std::string::npos) << value << " in " << frames[0];
  std::string broken = telegram;
  broken[broken.find("1581")] = '2';
  EXPECT_EQ(meter.hear(broken), Frames{});
}

// Constructed from the tables of Rice Lake, 680 Synergy Plus, 11.3.4, and Mettler-Toledo, Wildcat,
// Appendix 2: leading zeros are blanks.
TEST(Toledo, StatusWordASaysWhereThePointIs) {
  Station scale("toledo-continuous");
  EXPECT_EQ(scale.hear("12\r\x02\x2C\x30\x20  1234    50\r"), (Frames{"display: \x01 \x01"
                                                                      "12.34 0.50"}));
  EXPECT_EQ(scale.hear("\x02\x2A\x2A\x20"
                       "001234     0\r"),
            (Frames{"display: \x01 \x01 -1234 0"}));
  EXPECT_EQ(scale.hear("\x02\x28\x21\x20    12     3\r"), (Frames{"display: \x01 \x01 1200 300"}));
}

// Sources: Wikipedia, "NMEA 0183" (the first two); gpsinformation.org/dale/nmea.htm.
TEST(Nmea, ReadsPublishedSentences) {
  Station station("nmea-0183");
  EXPECT_EQ(
      station.hear("$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76\r\n"
                   "$GPGSA,A,3,10,07,05,02,29,04,08,13,,,,,1.72,1.03,1.38*0A\r\n"
                   "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
                   "$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48\r\n"),
      (Frames{"fix: 092750.0005321.6802 N 00630.3372 W 1 8 1.03 61.7",
              "fix: 123519 4807.038 N 01131.000 E 1 080.9 545.4",
              "speed: 054.7 034.4 005.5 010.2"}));
}

// Constructed: a receiver without a fix leaves its fields empty.
TEST(Nmea, ReadsEmptyFields) {
  Station station("nmea-0183");
  EXPECT_EQ(station.hear("$GPGGA,,,,,,0,,,,M,,M,,*66\r\n"), (Frames{"fix: 0"}));
}

TEST(Nmea, IgnoresBrokenSentences) {
  Station station("nmea-0183");
  const std::string good = "$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48\r\n";
  EXPECT_EQ(station.hear("$GPVTG,154.7,T,034.4,M,005.5,N,010.2,K*48\r\n"), Frames{});
  EXPECT_EQ(station.hear("$GPVTG,054.7,T,03" + good), Frames{"speed: 054.7 034.4 005.5 010.2"});
  EXPECT_EQ(station.hear(good.substr(0, 20)), Frames{});
  EXPECT_EQ(station.hear(good.substr(20)), Frames{"speed: 054.7 034.4 005.5 010.2"});
}

// Source of the format: A&D EK-i Series Instruction Manual, "A&D standard format".
TEST(ScaleStream, BeginsBehindTheEndOfAFrame) {
  Station station("scale-stream");
  // The rest of a frame whose beginning was missed is not a frame.
  EXPECT_EQ(station.hear("ST,+00123.45  g\r\n"), Frames{});
  EXPECT_EQ(station.hear("US,+00012.30  g\r\n"), Frames{"weighing: US+00012.30   g"});
  EXPECT_EQ(station.hear("ST,-0000"), Frames{});
  EXPECT_EQ(station.hear("1.00 kg\r\n"), Frames{"weighing: ST-00001.00  kg"});
  // A lost character breaks its frame only.
  EXPECT_EQ(station.hear("ST,+00123.4  g\r"), Frames{});
  EXPECT_EQ(station.hear("\nST,+00123.45  g\r\nST,+00123.46  g\r\n").size(), 2u);
}

TEST(ScaleStream, KeepsNoMoreThanAFrame) {
  Station station("scale-stream");
  for (int i = 0; i < 200; ++i) EXPECT_EQ(station.hear("0123456789"), Frames{});
  EXPECT_LT(station.kept(), 17u);
}

TEST(Unsolicited, RecordsCannotBeRequested) {
  const Device device = declared_device("nmea-0183", 1);
  for (const Area& area : device.protocol().areas()) {
    EXPECT_EQ(area.unsolicited, std::chrono::seconds{1});
    EXPECT_EQ(area.max_read, 0);
  }
  EXPECT_FALSE(device.protocol().size(ReadRequest{{{0, 0, 1}}}));
}

}  // namespace
}  // namespace fieldcast::test

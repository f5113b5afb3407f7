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

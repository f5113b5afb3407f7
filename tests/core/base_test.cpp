#include <gtest/gtest.h>

#include <memory>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/codec/checksum.hpp"
#include "core/frame/line.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(Hex, RoundTrips) {
  const Bytes bytes{0x01, 0x03, 0xFF};
  EXPECT_EQ(to_hex(bytes), "01 03 FF");
  EXPECT_EQ(to_hex(bytes, '\0'), "0103FF");
  EXPECT_EQ(from_hex("01 03 ff"), bytes);
  EXPECT_EQ(from_hex("0x01,0x03,0xFF"), bytes);
  EXPECT_EQ(from_hex("01:03-FF"), bytes);
  EXPECT_EQ(from_hex("0X01\t03\r\nFF"), bytes);
}

TEST(Hex, RefusesOddAndForeignDigits) {
  EXPECT_FALSE(from_hex("012"));
  EXPECT_FALSE(from_hex("0G"));
  EXPECT_FALSE(from_hex(std::string_view("0123").substr(0, 3))) << "the text ends before the 3";
  EXPECT_EQ(from_hex(""), Bytes{});
}

TEST(DurationText, ChoosesTheUnit) {
  EXPECT_EQ(to_text(Duration{}), "0s");
  EXPECT_EQ(to_text(500us), "500us");
  EXPECT_EQ(to_text(Duration{1500us}), "1.5ms");
  EXPECT_EQ(to_text(Duration{200ms}), "200ms");
  EXPECT_EQ(to_text(Duration{1s}), "1s");
  EXPECT_EQ(to_text(Duration{90s}), "90s");
  EXPECT_EQ(to_text(Duration{10min}), "10min");
  EXPECT_EQ(to_text(Duration{24h}), "24h");
  EXPECT_EQ(to_text(Duration{720h}), "30d");
}

TEST(ValueText, DoublesRoundTrip) {
  EXPECT_EQ(to_text(Value{100000.0}), "100000");
  EXPECT_EQ(to_text(Value{0.1}), "0.1");
  EXPECT_EQ(to_text(Value{true}), "true");
  EXPECT_EQ(to_text(Value{std::string{"abc"}}), "abc");
}

TEST(Causes, EachHasItsOwnNameAndText) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(Cause::kCount); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_NE(to_name(static_cast<Cause>(i)), to_name(static_cast<Cause>(k)));
      EXPECT_NE(to_text(static_cast<Cause>(i)), to_text(static_cast<Cause>(k)));
    }
  }
}

TEST(CauseCounters, TotalLeavesOutNone) {
  CauseCounters counters;
  counters.add(Cause::kNone);
  counters.add(Cause::kChecksum);
  counters.add(Cause::kChecksum);
  EXPECT_EQ(counters[Cause::kChecksum], 2u);
  EXPECT_EQ(counters.total(), 2u);
}

// Modbus over Serial Line V1.02, 2.5.1.1: 3.5 characters up to 19200 baud, 1.750 ms above.
TEST(Silence, FollowsTheStandard) {
  const auto at = [](std::uint32_t baud) {
    return silence_of(StandardSilence{}, LineFormat{baud, 8, Parity::kEven, 1});
  };
  EXPECT_NEAR(to_seconds(at(1200)), 0.0321, 1e-4);
  EXPECT_NEAR(to_seconds(at(9600)), 0.00401, 1e-5);
  EXPECT_NEAR(to_seconds(at(19200)), 0.002005, 1e-6);
  EXPECT_EQ(at(115200), Duration{1750us});
}

TEST(Line, CountsBits) {
  EXPECT_EQ((LineFormat{9600, 8, Parity::kEven, 1}.bits_per_character()), 11u);
  EXPECT_EQ((LineFormat{9600, 8, Parity::kNone, 1}.bits_per_character()), 10u);
  EXPECT_EQ((LineFormat{9600, 7, Parity::kEven, 2}.bits_per_character()), 11u);
}

Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }

// Bitwise CRC as in the standard; the reference for the table.
std::uint16_t slow_crc(ByteView bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int i = 0; i < 8; ++i) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xA001u : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

TEST(Checksum, CrcOfTheCheckStringIsTheCataloguesValue) {
  EXPECT_EQ(crc16_modbus(text("123456789")), 0x4B37);
}

TEST(Checksum, CrcTableEqualsBitwiseCrcForEveryLength) {
  Bytes bytes;
  std::uint32_t state = 1;
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(crc16_modbus(bytes), slow_crc(bytes)) << "length " << bytes.size();
    state = state * 1664525u + 1013904223u;
    bytes.push_back(static_cast<std::uint8_t>(state >> 24));
  }
}

TEST(Checksum, BytesAndTheirLrcAddUpToZero) {
  // Modbus over Serial Line V1.02, 6.2.1; the classic frame 11 03 00 6B 00 03 has LRC 7E.
  Bytes frame = *from_hex("11 03 00 6B 00 03");
  EXPECT_EQ(lrc8(frame), 0x7E);
  frame.push_back(0x7E);
  EXPECT_EQ(sum8(frame), 0);
  EXPECT_EQ(lrc8({}), 0);
}

TEST(Checksum, XorOfHostLinkText) {
  // `@00RD0150000351*`: a published read of D0150 (xamidimura roof_control, Host Link tests).
  EXPECT_EQ(xor8(text("@00RD01500003")), 0x51);
}

TEST(Checksum, TheTablesAreThoseOfTheBitwiseCrc) {
  const auto made = std::make_unique<detail::Crc16Tables>();
  EXPECT_EQ(made->of, detail::kCrc16Tables.of);
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte;
    for (int bit = 0; bit < 16; ++bit) {
      if (bit == 8) { EXPECT_EQ(made->of[0][byte], crc) << byte; }
      crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xA001u : crc >> 1;
    }
    EXPECT_EQ(made->of[1][byte], crc) << byte;
  }
}

TEST(Qualities, HaveTheNamesOfTheTopics) {
  EXPECT_EQ(to_text(Quality::kGood), "GOOD");
  EXPECT_EQ(to_text(Quality::kUncertain), "UNCERTAIN");
  EXPECT_EQ(to_text(Quality::kBadNoResponse), "BAD_NO_ANSWER");
  EXPECT_EQ(to_text(Quality::kBadFrame), "BAD_FRAME");
  EXPECT_EQ(to_text(Quality::kBadDeviceError), "BAD_DEVICE_ERROR");
  EXPECT_EQ(to_text(Quality::kBadRange), "BAD_RANGE");
  EXPECT_EQ(to_text(Quality::kBadConfiguration), "BAD_CONFIGURATION");
  EXPECT_EQ(to_text(Quality::kNotYetRead), "NOT_YET_READ");
  EXPECT_EQ(to_text(static_cast<Quality>(99)), "?");
}

}  // namespace
}  // namespace fieldcast

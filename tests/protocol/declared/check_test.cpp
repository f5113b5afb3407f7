// Tests the CRCs of declared protocols.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <tuple>

#include "core/protocol/declared/escape.hpp"
#include "core/protocol/declared/word.hpp"

namespace fieldcast::test {
namespace {

// Check values for "123456789" from the catalogue of parametrised CRC algorithms
// (reveng.sourceforge.io), of all algorithms of 8 to 64 bits.
TEST(DeclaredCheck, CrcsGiveTheirPublishedCheckValues) {
  const std::map<std::string_view, std::uint64_t> published{
      {"crc-8/autosar", 0xDF},
      {"crc-8/bluetooth", 0x26},
      {"crc-8/cdma2000", 0xDA},
      {"crc-8/darc", 0x15},
      {"crc-8/dvb-s2", 0xBC},
      {"crc-8/gsm-a", 0x37},
      {"crc-8/gsm-b", 0x94},
      {"crc-8/hitag", 0xB4},
      {"crc-8/i-432-1", 0xA1},
      {"crc-8/i-code", 0x7E},
      {"crc-8/lte", 0xEA},
      {"crc-8/maxim-dow", 0xA1},
      {"crc-8/mifare-mad", 0x99},
      {"crc-8/nrsc-5", 0xF7},
      {"crc-8/opensafety", 0x3E},
      {"crc-8/rohc", 0xD0},
      {"crc-8/sae-j1850", 0x4B},
      {"crc-8/smbus", 0xF4},
      {"crc-8/tech-3250", 0x97},
      {"crc-8/wcdma", 0x25},
      {"crc-10/atm", 0x199},
      {"crc-10/cdma2000", 0x233},
      {"crc-10/gsm", 0x12A},
      {"crc-11/flexray", 0x5A3},
      {"crc-11/umts", 0x61},
      {"crc-12/cdma2000", 0xD4D},
      {"crc-12/dect", 0xF5B},
      {"crc-12/gsm", 0xB34},
      {"crc-12/umts", 0xDAF},
      {"crc-13/bbc", 0x4FA},
      {"crc-14/darc", 0x82D},
      {"crc-14/gsm", 0x30AE},
      {"crc-15/can", 0x59E},
      {"crc-15/mpt1327", 0x2566},
      {"crc-16/arc", 0xBB3D},
      {"crc-16/cdma2000", 0x4C06},
      {"crc-16/cms", 0xAEE7},
      {"crc-16/dds-110", 0x9ECF},
      {"crc-16/dect-r", 0x7E},
      {"crc-16/dect-x", 0x7F},
      {"crc-16/dnp", 0xEA82},
      {"crc-16/en-13757", 0xC2B7},
      {"crc-16/genibus", 0xD64E},
      {"crc-16/gsm", 0xCE3C},
      {"crc-16/ibm-3740", 0x29B1},
      {"crc-16/ibm-sdlc", 0x906E},
      {"crc-16/iso-iec-14443-3-a", 0xBF05},
      {"crc-16/kermit", 0x2189},
      {"crc-16/lj1200", 0xBDF4},
      {"crc-16/m17", 0x772B},
      {"crc-16/maxim-dow", 0x44C2},
      {"crc-16/mcrf4xx", 0x6F91},
      {"crc-16/modbus", 0x4B37},
      {"crc-16/nrsc-5", 0xA066},
      {"crc-16/opensafety-a", 0x5D38},
      {"crc-16/opensafety-b", 0x20FE},
      {"crc-16/profibus", 0xA819},
      {"crc-16/riello", 0x63D0},
      {"crc-16/spi-fujitsu", 0xE5CC},
      {"crc-16/t10-dif", 0xD0DB},
      {"crc-16/teledisk", 0xFB3},
      {"crc-16/tms37157", 0x26B1},
      {"crc-16/umts", 0xFEE8},
      {"crc-16/usb", 0xB4C8},
      {"crc-16/xmodem", 0x31C3},
      {"crc-17/can-fd", 0x4F03},
      {"crc-21/can-fd", 0xED841},
      {"crc-24/ble", 0xC25A56},
      {"crc-24/flexray-a", 0x7979BD},
      {"crc-24/flexray-b", 0x1F23B8},
      {"crc-24/interlaken", 0xB4F3E6},
      {"crc-24/lte-a", 0xCDE703},
      {"crc-24/lte-b", 0x23EF52},
      {"crc-24/openpgp", 0x21CF02},
      {"crc-24/os-9", 0x200FA5},
      {"crc-30/cdma", 0x4C34ABF},
      {"crc-31/philips", 0xCE9E46C},
      {"crc-32/aixm", 0x3010BF7F},
      {"crc-32/autosar", 0x1697D06A},
      {"crc-32/base91-d", 0x87315576u},
      {"crc-32/bzip2", 0xFC891918u},
      {"crc-32/cd-rom-edc", 0x6EC2EDC4},
      {"crc-32/cksum", 0x765E7680},
      {"crc-32/iscsi", 0xE3069283u},
      {"crc-32/iso-hdlc", 0xCBF43926u},
      {"crc-32/jamcrc", 0x340BC6D9},
      {"crc-32/mef", 0xD2C22F51u},
      {"crc-32/mpeg-2", 0x376E6E7},
      {"crc-32/xfer", 0xBD0BE338u},
      {"crc-40/gsm", 0xD4164FC646u},
      {"crc-64/ecma-182", 0x6C40DF5F0B497347u},
      {"crc-64/go-iso", 0xB90956C775A41001u},
      {"crc-64/ms", 0x75D4B74F024ECEEAu},
      {"crc-64/nvme", 0xAE8B14860A799888u},
      {"crc-64/redis", 0xE9C6D914C4B8D9CAu},
      {"crc-64/we", 0x62EC59E3F1A4F00Au},
      {"crc-64/xz", 0x995DC9BBDF1939FAu},
  };
  const std::string_view digits = "123456789";
  const Bytes bytes(digits.begin(), digits.end());
  EXPECT_EQ(declared::crc_catalogue().size(), published.size());
  for (const auto& [name, crc] : declared::crc_catalogue()) {
    ASSERT_TRUE(published.contains(name)) << name;
    EXPECT_EQ(declared::crc_of(crc, bytes), published.at(name)) << name;
  }
}

Bytes unhex(std::string_view hex) { return from_hex(hex).value(); }

// That ends the escaped part of a frame.
Bytes mark_of(declared::Escape escape) {
  using enum declared::Escape;
  switch (escape) {
    case kDle: return {0x10, 0x03};
    case kSlip: return {0xC0};
    case kHdlc:
    case kShdlc: return {0x7E};
    case kKmp: return {0x0D};
    default: return {0x00};
  }
}

// Sources: RFC 1055 (SLIP); Cheshire and Baker, Consistent Overhead Byte Stuffing, and the examples
// of Wikipedia on it; RFC 1662 (HDLC); Sensirion, data sheet of the SPS30
// (SHDLC); github.com/gertvandijk/PyKMP (KMP).
TEST(DeclaredEscape, EncodesThePublishedExamples) {
  using declared::Escape;
  const std::tuple<Escape, std::string_view, std::string_view> examples[] = {
      {Escape::kDle, "01 10 02 10 10", "01 10 10 02 10 10 10 10"},
      {Escape::kSlip, "01 C0 DB 02", "01 DB DC DB DD 02"},
      {Escape::kCobs, "00", "01 01"},
      {Escape::kCobs, "00 00", "01 01 01"},
      {Escape::kCobs, "11 22 00 33", "03 11 22 02 33"},
      {Escape::kCobs, "11 22 33 44", "05 11 22 33 44"},
      {Escape::kCobs, "11 00 00 00", "02 11 01 01 01"},
      {Escape::kHdlc, "7E 00 7D 11", "7D 5E 00 7D 5D 11"},
      {Escape::kShdlc, "11 13 7E", "7D 31 7D 33 7D 5E"},
      {Escape::kKmp, "80 40 0D 06 1B 3F", "1B 7F 1B BF 1B F2 1B F9 1B E4 3F"}};
  for (const auto& [escape, plain, wire] : examples) {
    EXPECT_EQ(to_hex(escaped(escape, unhex(plain))), wire);
    Bytes marked = unhex(wire);
    append(marked, mark_of(escape));
    const auto read = unescape(escape, marked);
    EXPECT_TRUE(read.ended && !read.invalid) << wire;
    EXPECT_EQ(to_hex(read.plain), plain);
    EXPECT_EQ(read.used, unhex(wire).size());
  }
}

TEST(DeclaredEscape, AnyBytesReturnUnchanged) {
  std::mt19937 random(9);
  for (int round = 0; round < 2000; ++round) {
    Bytes plain(1 + random() % 600);
    for (auto& byte : plain)
      byte = static_cast<std::uint8_t>(random() % 3 == 0 ? 0x10 * (random() % 16) : random());
    if (round % 4 == 0) std::ranges::replace(plain, 0, 1);  // long groups of COBS
    for (const auto escape :
         {declared::Escape::kDle, declared::Escape::kSlip, declared::Escape::kCobs,
          declared::Escape::kHdlc, declared::Escape::kShdlc, declared::Escape::kKmp}) {
      Bytes wire = escaped(escape, plain);
      append(wire, mark_of(escape));
      const auto read = unescape(escape, wire);
      ASSERT_TRUE(read.ended && !read.invalid);
      ASSERT_EQ(read.plain, plain);
    }
  }
}

}  // namespace
}  // namespace fieldcast::test

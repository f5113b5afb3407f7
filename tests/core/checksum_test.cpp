#include "core/codec/checksum.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace fieldcast {
namespace {

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

}  // namespace
}  // namespace fieldcast

#include "core/program/last_request.hpp"

#include <gtest/gtest.h>

#include "core/program/frame.hpp"

namespace fieldcast::program {
namespace {

constexpr UtcTime kFirst{1'000}, kSecond{2'000};

TEST(LastRequest, IsDecodedWhenTheDeviceResponds) {
  LastRequest last("omron-hostlink", {});
  last.on_sent(as_bytes("@00RD0000"), kFirst);
  last.on_sent(as_bytes("000157*\r"), kSecond);
  EXPECT_FALSE(last.take());
  last.on_received();
  last.on_received();
  const auto decoded = last.take();
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->text, "RD read DM, first 0000, count 0001");
  EXPECT_EQ(decoded->sent_at.nanoseconds, kSecond.nanoseconds);
  EXPECT_FALSE(last.take());
}

TEST(LastRequest, IsTheNewestOne) {
  LastRequest last("omron-hostlink", {});
  for (const std::string_view frame : {"@00RD0000000157*\r", "@00MM40*\r"}) {
    last.on_sent(as_bytes(frame), kFirst);
    last.on_received();
  }
  EXPECT_EQ(last.take()->text, "MM model read");
}

TEST(LastRequest, BytesThatAreNoFrameAreNotDecoded) {
  LastRequest last("omron-hostlink", {});
  last.on_sent(as_bytes("@00RD0000000158*\r"), kFirst);
  last.on_received();
  EXPECT_FALSE(last.take());
  last.on_sent(Bytes(LastRequest::kMaxBytes + 10, 0x40), kFirst);
  last.on_received();
  EXPECT_FALSE(last.take());
}

TEST(LastRequest, AFrameInsideAFrameIsTheRequest) {
  LastRequest last("omron-hostlink", {});
  last.on_sent(as_bytes("@00FA00000000001010282006400000A0C*\r"), kFirst);
  last.on_received();
  EXPECT_EQ(last.take()->text, "0101 memory area read, parameters 02 82 00 64 00 00 0A");
}

TEST(LastRequest, OfAnUnknownProtocolIsNotDecoded) {
  LastRequest last;
  last.on_sent(as_bytes("@00MM40*\r"), kFirst);
  last.on_received();
  EXPECT_FALSE(last.take());
}

TEST(LastRequest, AFrameWithoutAnOperationIsNotDecoded) {
  LastRequest last("s7-ppi", {});
  last.on_sent(Bytes{0xE5}, kFirst);  // an acknowledgement
  last.on_received();
  EXPECT_FALSE(last.take());
}

}  // namespace
}  // namespace fieldcast::program

#include "bridge/bus/wire_record.hpp"

#include <gtest/gtest.h>

#include "core/bus/bus_engine.hpp"

namespace fieldcast::test {
namespace {

constexpr UtcTime at(std::int64_t milliseconds) { return {milliseconds * 1'000'000}; }

struct WireRecordTest : testing::Test {
  WireRecordTest() { record.set_tap(tap); }
  // "received 01 02", ..
  std::vector<std::string> taken() {
    std::vector<std::string> all;
    for (const CaptureRecord& each : tap->take().records) {
      const bool bytes = each.kind == CaptureRecord::Kind::kReceived;
      all.push_back(bytes                                      ? to_hex(each.bytes)
                    : each.kind == CaptureRecord::Kind::kEnded ? "ended"
                                                               : each.text);
    }
    return all;
  }
  std::shared_ptr<CaptureTap> tap = std::make_shared<CaptureTap>();
  WireRecord record{"bus"};
};

using Lines = std::vector<std::string>;

TEST_F(WireRecordTest, ACaptureBeginsBehindAFrameThatHasBegun) {
  record.received(Bytes{1, 2}, at(0));
  tap->want(CaptureTap::Wanted::kEverything);
  record.received(Bytes{3}, at(5));
  record.traced({"pump", "read holding:1: 1 item"}, at(6));
  record.frame_ended(at(6));
  EXPECT_EQ(taken(), Lines{});
  record.received(Bytes{4}, at(10));
  record.traced({"pump", "read holding:2: 1 item"}, at(11));
  record.frame_ended(at(11));
  EXPECT_EQ(taken(), (Lines{"04", "pump: read holding:2: 1 item", "ended"}));
}

TEST_F(WireRecordTest, ACaptureBetweenTwoFramesHasTheNextOne) {
  record.received(Bytes{1, 2}, at(0));
  record.frame_ended(at(1));
  tap->want(CaptureTap::Wanted::kEverything);
  record.received(Bytes{3}, at(2));
  EXPECT_EQ(taken(), Lines{"03"});
}

// Bytes of another master end no frame of ours.
TEST_F(WireRecordTest, AfterAPauseBytesBeginAFrame) {
  record.received(Bytes{1, 2}, at(0));
  tap->want(CaptureTap::Wanted::kEverything);
  record.received(Bytes{3}, at(200));
  EXPECT_EQ(taken(), Lines{});
  record.received(Bytes{4}, at(500));
  EXPECT_EQ(taken(), Lines{"04"});
}

}  // namespace
}  // namespace fieldcast::test

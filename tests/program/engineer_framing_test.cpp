#include <gmock/gmock.h>

#include "tests/program/engineer_bench.hpp"

namespace fieldcast::program {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using Bench = EngineerBench;

TEST(Engineer, AContinuationThatBeginsLikeAControlFrameReachesItsSide) {
  Bench b;
  b.pair();
  b.sends("@@0000FEFF12\rFEFF@@EDFEFF34\rFE");
  b.sends("FF");
  EXPECT_EQ(b.reached(), "0000FEFF12\rEDFEFF34\r");
  b.answers("0000FEFF56\r0003FEFF78*\r");
  EXPECT_EQ(b.received(), "@@0000FEFF56\rFEFF@@0003FEFF78*\rFEFF");
  EXPECT_TRUE(b.engineer.paired());
  EXPECT_THAT(b.remarks.back().kind, Remark::Kind::kPaired);  // nothing was dropped
}

TEST(Engineer, HalfAnInstructionIsDroppedAndReportedNeverSent) {
  Bench b;
  b.pair();
  b.sends("@@@00FA");
  b.pass(milliseconds{1900});
  b.sends("00");
  b.pass(milliseconds{1999});
  EXPECT_THAT(b.remarks.back().kind, Remark::Kind::kPaired);
  b.pass(milliseconds{2});
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kDropped);
  b.sends("@@@00next*\rFEFF");
  EXPECT_EQ(b.reached(), "@00next*\r");
  b.answers("@00half");
  b.pass(milliseconds{2001});
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kDropped);
  b.answers("@00ok*\r");
  EXPECT_THAT(b.received(), HasSubstr("@@@00ok*\rFEFF"));
}

Bytes chunk(std::string_view text) {
  Bytes out;
  append_chunks(out, as_bytes(text));
  return out;
}

TEST(Engineer, FramingByLengthIsNegotiatedAndCarriesAnything) {
  Bench b;
  b.pair("@@V217FEFF");
  b.tell(FromClient{chunk("@@EDFEFF\r\xFF")});
  EXPECT_EQ(b.reached(), "@@EDFEFF\r\xFF");
  b.answers("half of an answer");
  EXPECT_EQ(b.client, chunk("half of an answer"));
  b.client.clear();
  b.pass(milliseconds{5001});
  EXPECT_EQ(b.client, (Bytes{0, 0, 0, 0}));
}

TEST(Engineer, LineSettingsComeBetweenTheBytesAroundThem) {
  Bench b;
  b.pair("@@V217FEFF");
  Bytes stream = chunk("slow");
  append_settings(stream, {115200, 2, 0, Parity::kNone});
  append(stream, chunk("fast"));
  EngineerActions actions;
  b.engineer.on_event(FromClient{stream}, b.now, actions);
  std::string order;
  for (const auto& action : actions) {
    if (auto* to = std::get_if<ToDevice>(&action)) order += std::string(as_text(to->bytes)) + ' ';
    if (auto* line = std::get_if<SetLine>(&action))
      order += std::to_string(line->settings.baud) + ' ';
  }
  EXPECT_EQ(order, "slow 115200 fast ");
}

// The order matters: after the stop, the device may have another user.
TEST(Engineer, BytesBeforeAStopOrAnInvalidLengthReachTheDeviceBeforeItIsFreed) {
  for (const Bytes& end : {Bytes{0xFF, 0xFF, 0xFF, 0xFF}, Bytes{0x40, 0x40, 0x31, 0x37}}) {
    Bench b;
    b.pair("@@V217FEFF");
    Bytes stream = chunk("last");
    append(stream, end);
    EngineerActions actions;
    b.engineer.on_event(FromClient{stream}, b.now, actions);
    std::string order;
    for (const auto& action : actions) {
      if (auto* to = std::get_if<ToDevice>(&action)) order += as_text(to->bytes);
      if (std::holds_alternative<FreeDevice>(action)) order += " freed";
    }
    EXPECT_EQ(order, "last freed");
  }
}

TEST(Engineer, BytesBeforeTheDeviceIsGivenReachItLater) {
  Bench by_markers;
  by_markers.sends("@@17FEFF@@@00MM40*\rFEFF");
  EXPECT_EQ(by_markers.reached(), "");
  by_markers.tell(DeviceGiven{});
  EXPECT_EQ(by_markers.reached(), "@00MM40*\r");

  Bench by_length;
  Bytes stream;
  append(stream, as_bytes("@@V217FEFF"));
  append(stream, chunk("early"));
  by_length.tell(FromClient{stream});
  EXPECT_EQ(by_length.reached(), "");
  by_length.tell(DeviceGiven{});
  EXPECT_EQ(by_length.reached(), "early");
}

TEST(Engineer, WithFramingByLengthTheLossIsAStopAndItsReason) {
  Bench b;
  b.pair("@@V217FEFF");
  b.tell(DeviceLost{"gone"});
  Bytes expected{0xFF, 0xFF, 0xFF, 0xFF};
  append(expected, control_frame("0003"));
  EXPECT_EQ(b.client, expected);
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, AStreamThatMakesNoSenseEndsThePairing) {
  Bench b;
  b.pair("@@V217FEFF");
  b.sends("@@17FEFF");  // 40403137h bytes
  EXPECT_EQ(b.freed, 1);
  EXPECT_TRUE(b.engineer.over());
  EXPECT_EQ(b.reached(), "");
}

TEST(Engineer, AnInstructionThatIsTooLongIsDroppedInEitherDirection) {
  const std::string too_long(kMaxInstruction + 1, 'x');
  Bench b;
  b.pair();
  b.answers(too_long + "\r@00ok*\r");
  EXPECT_EQ(b.received(), "@@@00ok*\rFEFF");
  EXPECT_THAT(b.last_remark(), HasSubstr("more than 4096 characters"));
  b.sends("@@" + too_long + "\rFEFF@@next\rFEFF");
  EXPECT_EQ(b.reached(), "next\r");
  EXPECT_TRUE(b.engineer.paired());
}

TEST(Engineer, AHandshakeThatIsTooLongIsNoise) {
  Bench b;
  b.sends("@@" + std::string(kMaxHandshakeCode + 1, '1') + "FEFF");
  EXPECT_THAT(b.taken, testing::IsEmpty());
  EXPECT_EQ(b.remarks.front().kind, Remark::Kind::kDropped);
  EXPECT_EQ(b.last_remark(), "noise instead of frames");
}

TEST(Engineer, AHeartbeatOfLengthsReachesNoDevice) {
  Bench b;
  b.pair("@@V217FEFF");
  b.tell(FromClient{Bytes{0, 0, 0, 0}});
  EXPECT_EQ(b.reached(), "");
  EXPECT_TRUE(b.engineer.paired());
}

TEST(Engineer, WithFramingByLengthEveryEndDisconnectsOnce) {
  for (const EngineerEvent& end :
       {EngineerEvent{ClientGone{"reset"}}, EngineerEvent{Ended{"the bridge stops"}}}) {
    Bench b;
    b.pair("@@V217FEFF");
    b.tell(end);
    EXPECT_TRUE(b.engineer.over());
    EXPECT_EQ(b.freed, 1);
    EXPECT_EQ(b.hung_up, 1);
  }
}

}  // namespace
}  // namespace fieldcast::program

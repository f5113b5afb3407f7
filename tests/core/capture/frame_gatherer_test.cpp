#include <gtest/gtest.h>

#include "core/capture/capture_record.hpp"

namespace fieldcast {
namespace {

using Kind = CaptureRecord::Kind;

UtcTime ms(std::int64_t at) { return {at * 1'000'000}; }

class FrameGathererTest : public testing::Test {
 protected:
  void take(Kind kind, std::int64_t at, const std::string& hex, const std::string& text = {}) {
    gatherer_.take({kind, ms(at), 0, *from_hex(hex), text}, frames_);
  }
  void take_session(Kind kind, std::int64_t at, const std::string& hex) {
    gatherer_.take({kind, ms(at), 0, *from_hex(hex), "by anna", true}, frames_);
  }
  void take_text(Kind kind, std::int64_t at, const std::string& text = {}) {
    gatherer_.take({kind, ms(at), 0, {}, text}, frames_);
  }
  // Returns one line per frame, for example "0 > 01 03 [comment]".
  [[nodiscard]] std::string frames() const {
    std::string text;
    for (const CapturedFrame& frame : frames_)
      text += std::to_string(frame.at.nanoseconds / 1'000'000) +
              (frame.direction == Direction::kSent ? " > " : " < ") + to_hex(frame.bytes) +
              (frame.comment.empty() ? "" : " [" + frame.comment + "]") + "\n";
    return text;
  }

  FrameGatherer gatherer_;
  std::vector<CapturedFrame> frames_;
};

TEST_F(FrameGathererTest, PiecesOfAResponseAreOneFrameWithTheTimeOfTheLast) {
  take(Kind::kSent, 0, "01 03 00", "read");
  take(Kind::kReceived, 5, "01 03 02");
  take(Kind::kReceived, 25, "00 2A");
  take_text(Kind::kRemark, 25, "1 sample");
  EXPECT_EQ(frames(), "0 > 01 03 00 [read]\n25 < 01 03 02 00 2A [1 sample]\n");
}

TEST_F(FrameGathererTest, ARequestWithoutResponseIsReported) {
  take(Kind::kSent, 0, "01 03", "read");
  take_text(Kind::kRemark, 200, "no response");
  EXPECT_EQ(frames(), "0 > 01 03 [read\nno response]\n");
}

TEST_F(FrameGathererTest, EachRoundOfAnExchangeIsAFrameOfItsOwn) {
  take(Kind::kSent, 0, "68");
  take(Kind::kReceived, 5, "E5");
  take(Kind::kSent, 6, "10");
  take(Kind::kReceived, 9, "68 02");
  take_text(Kind::kEnded, 9);
  EXPECT_EQ(frames(), "0 > 68\n5 < E5\n6 > 10\n9 < 68 02\n");
}

// Programming software writes a request in pieces, and nobody says where it ends.
TEST_F(FrameGathererTest, PiecesOfASessionInOneDirectionAreOneFrame) {
  take_session(Kind::kSent, 0, "40 30");
  take_session(Kind::kSent, 3, "30 0D");
  take_session(Kind::kReceived, 20, "40 30");
  take_session(Kind::kReceived, 40, "0D");
  take_session(Kind::kSent, 60, "40");
  take_session(Kind::kSent, 311, "41");  // too late for the same frame
  gatherer_.look(ms(561), frames_);
  EXPECT_EQ(frames(), "3 > 40 30 30 0D [by anna]\n40 < 40 30 0D\n60 > 40 [by anna]\n");
  gatherer_.look(ms(562), frames_);
  EXPECT_EQ(frames_.size(), 4u);
  EXPECT_TRUE(frames_.back().session);
}

// The bus reports after each piece that no response is awaited.
TEST_F(FrameGathererTest, PiecesOfAnUnsolicitedFrameAreOneFrame) {
  take_text(Kind::kEnded, 0);  // the capture begins between two frames
  for (const std::int64_t at : {0, 100}) {
    take(Kind::kReceived, at, "53 54 2C");
    take_text(Kind::kEnded, at);
    take(Kind::kReceived, at + 12, "31 32 0D");
    take_text(Kind::kRemark, at + 12, "unsolicited");
    take_text(Kind::kEnded, at + 12);
  }
  take(Kind::kReceived, 200, "53 54");
  take_text(Kind::kEnded, 200);
  gatherer_.look(ms(260), frames_);
  EXPECT_EQ(frames(),
            "12 < 53 54 2C 31 32 0D [unsolicited]\n112 < 53 54 2C 31 32 0D [unsolicited]\n"
            "200 < 53 54\n");
}

TEST_F(FrameGathererTest, AnEchoIsNotAPartOfTheResponse) {
  take(Kind::kSent, 0, "01 03");
  take(Kind::kReceived, 5, "01");
  take(Kind::kReceived, 6, "03 01 83");
  gatherer_.flush(frames_);
  EXPECT_EQ(frames(), "0 > 01 03\n6 > 01 03 [the line gave the request back (echo)]\n6 < 01 83\n");
}

TEST_F(FrameGathererTest, AResponseThatEqualsItsRequestIsAResponse) {
  take(Kind::kSent, 0, "01 06 00");
  take(Kind::kReceived, 5, "01 06 00");
  take_text(Kind::kEnded, 5);
  EXPECT_EQ(frames(), "0 > 01 06 00\n5 < 01 06 00\n");
}

TEST_F(FrameGathererTest, WhatNobodyAskedForIsCutBySilence) {
  take(Kind::kReceived, 0, "AA");
  take(Kind::kReceived, 20, "BB");
  take(Kind::kReceived, 120, "CC");
  gatherer_.look(ms(140), frames_);
  EXPECT_EQ(frames(), "20 < AA BB\n");
  gatherer_.look(ms(200), frames_);
  EXPECT_EQ(frames(), "20 < AA BB\n120 < CC\n");
}

TEST_F(FrameGathererTest, TheRestOfAResponseAtTheBeginningIsLeftOut) {
  take(Kind::kReceived, 0, "02 00 2A");
  take_text(Kind::kRemark, 0, "1 sample");
  take(Kind::kSent, 10, "01 03 00");
  take_text(Kind::kEnded, 20);
  EXPECT_EQ(frames(), "10 > 01 03 00\n");
}

TEST_F(FrameGathererTest, WhatIsMissingIsSaidAtTheNextFrame) {
  take(Kind::kSent, 0, "01");
  gatherer_.lost(17, frames_);
  take(Kind::kReceived, 50, "02");
  gatherer_.flush(frames_);
  EXPECT_EQ(frames(),
            "0 > 01\n50 < 02 [17 pieces are missing before this frame: the capture was too slow "
            "for them]\n");
}

TEST_F(FrameGathererTest, AFloodIsCutIntoFrames) {
  gatherer_.take({Kind::kReceived, ms(0), 0, Bytes(FrameGatherer::kMaxFrame + 3), {}}, frames_);
  gatherer_.flush(frames_);
  ASSERT_EQ(frames_.size(), 2u);
  EXPECT_EQ(frames_[0].bytes.size(), FrameGatherer::kMaxFrame);
  EXPECT_EQ(frames_[1].bytes.size(), 3u);
}

TEST_F(FrameGathererTest, ALongCommentIsCutBetweenCharacters) {
  std::string text(FrameGatherer::kMaxComment - 1, 'x');
  take(Kind::kSent, 0, "01", text + "°C");
  gatherer_.flush(frames_);
  EXPECT_EQ(frames_[0].comment, text);
}

TEST_F(FrameGathererTest, ARemarkBeforeAnyFrameIsSaidAtTheNextOne) {
  take_text(Kind::kRemark, 0, "reconnected");
  take(Kind::kSent, 5, "01 03", "read");
  gatherer_.flush(frames_);
  EXPECT_EQ(frames(), "5 > 01 03 [reconnected\nread]\n");
}

TEST_F(FrameGathererTest, RemarksBeforeAFrameAreBounded) {
  const std::string text(FrameGatherer::kMaxComment, 'x');
  take_text(Kind::kRemark, 0, text);
  take_text(Kind::kRemark, 1, "left out");
  take(Kind::kSent, 5, "01");
  gatherer_.flush(frames_);
  EXPECT_EQ(frames_[0].comment, text);
}

TEST_F(FrameGathererTest, AResponseInFlightIsNotCutBySilence) {
  take(Kind::kSent, 0, "01 03");
  take(Kind::kReceived, 5, "01");
  gatherer_.look(ms(10'000), frames_);
  EXPECT_EQ(frames(), "0 > 01 03\n");
  take(Kind::kReceived, 10'001, "83 02");
  take_text(Kind::kEnded, 10'001);
  EXPECT_EQ(frames(), "0 > 01 03\n10001 < 01 83 02\n");
}

TEST_F(FrameGathererTest, ASessionDoesNotContinueARequestOfTheBus) {
  take(Kind::kSent, 0, "01 03", "read");
  take_session(Kind::kSent, 1, "40");
  take(Kind::kSent, 2, "01 04", "read");
  gatherer_.flush(frames_);
  EXPECT_EQ(frames(), "0 > 01 03 [read]\n1 > 40 [by anna]\n2 > 01 04 [read]\n");
}

TEST_F(FrameGathererTest, AnEndlessRequestOfASessionIsCutIntoFrames) {
  const Bytes most(FrameGatherer::kMaxFrame, 0x40);
  gatherer_.take({Kind::kSent, ms(0), 0, most, "by anna", true}, frames_);
  take_session(Kind::kSent, 1, "41");
  gatherer_.flush(frames_);
  ASSERT_EQ(frames_.size(), 2u);
  EXPECT_EQ(frames_[0].bytes, most);
  EXPECT_EQ(frames_[1].bytes, Bytes{0x41});
}

TEST_F(FrameGathererTest, ACaptureThatBeginsInAResponseStartsAtTheNextRequest) {
  take(Kind::kReceived, 0, "02 00 2A");
  take(Kind::kSent, 1, "01 03");
  take(Kind::kReceived, 5, "");
  take_text(Kind::kEnded, 6);
  EXPECT_EQ(frames(), "1 > 01 03\n") << "an empty piece is not a frame";
}

}  // namespace
}  // namespace fieldcast

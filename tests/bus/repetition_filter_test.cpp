#include "core/bus/wire/repetition_filter.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

const LineFormat kRepeatingLine{19200, 8, Parity::kEven, 1};
const Bytes kResponse{0x01, 0x03, 0x02, 0x03, 0xEB, 0xF8, 0xFB};
const Bytes kNext{0x01, 0x03, 0x02, 0x03, 0xEC, 0xB9, 0x39};
const Duration kCharacters = kRepeatingLine.characters(7);

class RepetitionFilterTest : public testing::Test {
 protected:
  RepetitionFilterTest() { filter_.responded(1, kResponse, 7, Instant{1s}); }
  static Bytes joined(const Bytes& first, const Bytes& second) {
    Bytes all = first;
    append(all, second);
    return all;
  }
  RepetitionFilter filter_{kRepeatingLine, 20ms, 2};
};

TEST_F(RepetitionFilterTest, FindsTheEndOfTheSameFrame) {
  EXPECT_EQ(filter_.find(kResponse, Instant{1s}), 7u);
  EXPECT_EQ(filter_.find(joined(kResponse, kNext), Instant{1s}), 7u);
  EXPECT_EQ(filter_.find(joined({0x00}, kResponse), Instant{1s}), 8u) << "behind noise";
  EXPECT_EQ(filter_.find(kNext, Instant{1s}), 0u);
  EXPECT_EQ(filter_.find({kResponse.begin(), kResponse.end() - 1}, Instant{1s}), 0u);
}

TEST_F(RepetitionFilterTest, ARepetitionArrivesWithinItsTimeOnTheWireAndTheDelay) {
  const Instant until = Instant{1s} + kCharacters + 20ms;
  EXPECT_EQ(filter_.find(kResponse, until - 1ns), 7u);
  EXPECT_EQ(filter_.find(kResponse, until), 0u);
}

TEST_F(RepetitionFilterTest, AFrameIsRepeatedOnce) {
  filter_.discard();
  EXPECT_EQ(filter_.find(kResponse, Instant{1s}), 0u);
}

TEST_F(RepetitionFilterTest, AFrameInFrontOfAResponseWasARepetition) {
  filter_.discard();
  filter_.responded(1, kNext, 7, Instant{2s});
  EXPECT_TRUE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, AFrameInFrontOfNoiseWasPerhapsTheResponse) {
  filter_.discard();
  filter_.asked();
  filter_.responded(1, kNext, 7, Instant{2s});
  EXPECT_FALSE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, TheWireRestsBehindResponsesOfADeviceThatRepeats) {
  EXPECT_EQ(filter_.rest_until(), kLongAgo);
  filter_.stray(kResponse, Instant{1s});
  filter_.responded(0, kNext, 7, Instant{2s});
  EXPECT_EQ(filter_.rest_until(), kLongAgo) << "another device";
  for (unsigned i = 1; i < RepetitionFilter::kWatched; ++i) {
    filter_.responded(1, kNext, 7, Instant{2s});
    EXPECT_EQ(filter_.rest_until(), Instant{2s} + kCharacters + 20ms) << i;
  }
  filter_.responded(1, kNext, 7, Instant{3s});
  EXPECT_EQ(filter_.rest_until(), kLongAgo);
}

TEST_F(RepetitionFilterTest, ANewDeviceOfTheIndexIsHealthy) {
  filter_.stray(kResponse, Instant{1s});
  EXPECT_TRUE(filter_.watches(1));
  filter_.replaced(1);
  EXPECT_FALSE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, TheSameFrameWithoutARequestIsARepetition) {
  filter_.stray({kResponse.data(), 3}, Instant{1s + 2ms});
  EXPECT_FALSE(filter_.watches(1));
  filter_.stray(ByteView(kResponse).subspan(3), Instant{1s + 4ms});
  EXPECT_TRUE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, OtherOrLaterBytesAreNot) {
  filter_.stray(kNext, Instant{1s + 2ms});
  filter_.asked();
  filter_.stray(kResponse, Instant{1s} + kCharacters + 20ms + 1ns);
  EXPECT_FALSE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, BytesBeforeARequestAndBehindItAreNotOneFrame) {
  filter_.stray({kResponse.data(), 3}, Instant{1s + 2ms});
  filter_.asked();
  filter_.stray(ByteView(kResponse).subspan(3), Instant{1s + 4ms});
  EXPECT_FALSE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, TwoEqualFramesInOneReadAreOneResponseAndItsRepetition) {
  filter_.responded(1, joined(kNext, kNext), 7, Instant{2s});
  EXPECT_TRUE(filter_.watches(1));
  EXPECT_EQ(filter_.find(kNext, Instant{2s}), 0u) << "its repetition has arrived";
}

TEST_F(RepetitionFilterTest, AnOddOrEmptyResponseIsNotTwoFrames) {
  filter_.responded(1, {}, 0, Instant{2s});
  EXPECT_FALSE(filter_.watches(1));
  filter_.responded(1, Bytes{0x06}, 0, Instant{2s});
  EXPECT_FALSE(filter_.watches(1));
  filter_.responded(1, Bytes{0x06, 0x06, 0x06}, 0, Instant{2s});
  EXPECT_FALSE(filter_.watches(1));
  filter_.responded(1, Bytes{0x06, 0x06}, 0, Instant{2s});
  EXPECT_TRUE(filter_.watches(1));
}

TEST_F(RepetitionFilterTest, NoiseInFrontIsNoPartOfTheResponse) {
  filter_.responded(1, joined({0xFF, 0x00}, kNext), 7, Instant{2s});
  EXPECT_EQ(filter_.find(kNext, Instant{2s}), 7u);
}

TEST_F(RepetitionFilterTest, ARefusalIsShorterThanTheResponse) {
  const Bytes refusal{0x01, 0x83, 0x02, 0xC0, 0xF1};
  filter_.responded(1, refusal, 7, Instant{2s});
  EXPECT_EQ(filter_.find(refusal, Instant{2s}), 5u);
}

}  // namespace
}  // namespace fieldcast

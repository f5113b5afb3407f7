#include "core/bus/conversation.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using Outcome = Conversation::Outcome;

const LineFormat kLine{19200, 8, Parity::kEven, 1};
const Bytes kRequest{0x01, 0x03, 0x00, 0x64, 0x00, 0x01, 0xC5, 0xD5};
const Bytes kAnswer{0x01, 0x03, 0x02, 0x00, 0x2A, 0x39, 0x9B};

struct Line {
  explicit Line(Echo echo = Echo::kAbsent) : conversation(kLine, 20ms, echo) {}
  void ask(Instant at, Request request = ReadRequest{{{2, 100, 1}}}, bool distinct = true) {
    conversation.begin(protocol->begin(std::move(request), {1}), 200ms, distinct, at, out);
  }
  Outcome hear(const Bytes& bytes, Instant at) { return conversation.on_bytes(bytes, at, out); }

  std::unique_ptr<Protocol> protocol = std::move(*find_protocol("modbus-rtu")->make({1, {}}));
  Conversation conversation;
  Bytes out;
};

TEST(Conversation, AsksAndIsAnswered) {
  Line line;
  line.ask(Instant{});
  EXPECT_EQ(line.out, kRequest);
  EXPECT_EQ(line.hear(kAnswer, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.conversation.exchange().reply().front().items, (Bytes{0x00, 0x2A}));
  EXPECT_EQ(line.conversation.answered(), Instant{20ms});
}

TEST(Conversation, AnswerTimeIsWithoutTheWire) {
  Line line;
  line.ask(Instant{});
  const Duration wire = kLine.characters(8) + kLine.characters(7);
  (void)line.hear(kAnswer, Instant{wire + 5ms});
  EXPECT_NEAR(to_seconds(line.conversation.answer_time()), 0.005, 1e-6);
}

TEST(Conversation, KnowsWhatTheAnswerLacks) {
  Line line;
  line.ask(Instant{});
  EXPECT_EQ(line.conversation.missing(), 0u) << "when the answer begins is not known";
  (void)line.hear({kAnswer.begin(), kAnswer.begin() + 3}, Instant{20ms});
  EXPECT_EQ(line.conversation.missing(), 4u);
  (void)line.hear({kAnswer.begin() + 3, kAnswer.end() - 1}, Instant{21ms});
  EXPECT_EQ(line.conversation.missing(), 1u);
  EXPECT_EQ(line.hear({kAnswer.end() - 1, kAnswer.end()}, Instant{22ms}), Outcome::kDone);
  line.conversation.finish();
  EXPECT_EQ(line.conversation.missing(), 0u);
}

TEST(Conversation, SilenceEndsItAfterTheTimeout) {
  Line line;
  line.ask(Instant{});
  EXPECT_EQ(line.conversation.deadline(), Instant{200ms} + kLine.characters(8));
  EXPECT_EQ(line.conversation.on_timer(line.conversation.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.conversation.cause(), Cause::kNoAnswer);
}

TEST(Conversation, BrokenAnswerEndsSoonAfterItsWireTime) {
  Line line;
  line.ask(Instant{});
  Bytes broken = kAnswer;
  broken.back() ^= 1;
  EXPECT_EQ(line.hear(broken, Instant{20ms}), Outcome::kWaiting);
  EXPECT_LE(line.conversation.deadline(), Instant{50ms});
  EXPECT_EQ(line.conversation.on_timer(line.conversation.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.conversation.cause(), Cause::kChecksum);
}

TEST(Conversation, BabbleCannotHoldTheWire) {
  Line line;
  line.ask(Instant{});
  Instant now{10ms};
  const Bytes noise{0x01, 0x03, 0x02};
  for (int i = 0; i < 10000 && now < line.conversation.deadline(); ++i) {
    if (line.hear(noise, now) != Outcome::kWaiting) break;
    now += 1ms;
  }
  EXPECT_LT(now, Instant{300ms});
}

TEST(Conversation, EchoIsLearnedFromARead) {
  Line line(Echo::kUnknown);
  line.ask(Instant{});
  EXPECT_EQ(line.hear(kRequest, Instant{5ms}), Outcome::kWaiting);
  EXPECT_EQ(line.conversation.echo(), Echo::kPresent);
  EXPECT_EQ(line.hear(kAnswer, Instant{20ms}), Outcome::kDone);
}

TEST(Conversation, EchoAndAnswerInOnePieceAreToldApart) {
  Line line(Echo::kUnknown);
  line.ask(Instant{});
  Bytes both = kRequest;
  append(both, kAnswer);
  EXPECT_EQ(line.hear(both, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.conversation.echo(), Echo::kPresent);
}

TEST(Conversation, AnAnswerWithoutEchoShowsThatThereIsNone) {
  Line line(Echo::kUnknown);
  line.ask(Instant{});
  EXPECT_EQ(line.hear(kAnswer, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.conversation.echo(), Echo::kAbsent);
}

TEST(Conversation, EchoOfAWriteIsNoAnswer) {
  Line line(Echo::kPresent);
  line.ask(Instant{}, WriteRequest{{2, 100, 1}, {0x00, 0x05}, {}, false}, false);
  const Bytes sent = line.out;
  EXPECT_EQ(line.hear(sent, Instant{5ms}), Outcome::kWaiting);
  EXPECT_EQ(line.conversation.on_timer(line.conversation.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.conversation.cause(), Cause::kNoAnswer);
}

TEST(Conversation, SecondCopyOfAWriteIsTheAnswer) {
  Line line(Echo::kPresent);
  line.ask(Instant{}, WriteRequest{{2, 100, 1}, {0x00, 0x05}, {}, false}, false);
  const Bytes sent = line.out;
  EXPECT_EQ(line.hear(sent, Instant{5ms}), Outcome::kWaiting);
  EXPECT_EQ(line.hear(sent, Instant{20ms}), Outcome::kDone);
}

TEST(Conversation, EndlessBytesFailAsOverlong) {
  Line line;
  line.ask(Instant{});
  const Bytes flood(Conversation::kMaxReceived + 1, 0x55);
  EXPECT_EQ(line.hear(flood, Instant{20ms}), Outcome::kFailed);
  EXPECT_EQ(line.conversation.cause(), Cause::kOverlong);
}

}  // namespace
}  // namespace fieldcast

#include "core/bus/wire/exchange_driver.hpp"

#include <gtest/gtest.h>

#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using Outcome = ExchangeDriver::Outcome;

const LineFormat kLine{19200, 8, Parity::kEven, 1};
const Bytes kRequest{0x01, 0x03, 0x00, 0x64, 0x00, 0x01, 0xC5, 0xD5};
const Bytes kAnswer{0x01, 0x03, 0x02, 0x00, 0x2A, 0x39, 0x9B};

struct Line {
  explicit Line(Echo echo = Echo::kAbsent) : driver(kLine, 20ms, echo) {}
  void ask(Instant at, Request request = ReadRequest{{{2, 100, 1}}},
           EqualBytes equal = EqualBytes::kEcho) {
    driver.begin(protocol->begin(std::move(request), {1}), 200ms, equal, at, out);
  }
  Outcome receive(const Bytes& bytes, Instant at) { return driver.on_bytes(bytes, at, out); }

  std::unique_ptr<Protocol> protocol = std::move(*find_protocol("modbus-rtu")->make({1, {}}));
  ExchangeDriver driver;
  Bytes out;
};

TEST(ExchangeDriver, RequestsAndGetsAResponse) {
  Line line;
  line.ask(Instant{});
  EXPECT_EQ(line.out, kRequest);
  EXPECT_EQ(line.receive(kAnswer, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.driver.exchange().reply().front().items, (Bytes{0x00, 0x2A}));
  EXPECT_EQ(line.driver.responded(), Instant{20ms});
}

TEST(ExchangeDriver, AConfirmationOccupiesTheWireAndIsNotTheRequest) {
  Line line;
  line.protocol = std::move(*find_protocol("allen-bradley-df1")->make({1, {}}));
  line.ask(Instant{}, ReadRequest{{{0, 7000, 1}}});
  const Bytes request = line.out;
  const Bytes response = *from_hex("10 06 10 02 00 01 4F 00 01 00 2A 00 10 03 23 01");
  EXPECT_EQ(line.receive(response, Instant{100ms}), Outcome::kDone);
  EXPECT_EQ(line.out, *from_hex("10 06"));
  EXPECT_EQ(line.driver.confirmed_until(), Instant{100ms} + kLine.characters(2));
  EXPECT_EQ(line.driver.sent_until(),
            Instant{} + kLine.characters(static_cast<double>(request.size())));
  EXPECT_EQ(line.driver.sent().size(), request.size());
  EXPECT_EQ(line.driver.bytes_sent(), request.size() + 2);
}

TEST(ExchangeDriver, ResponseTimeIsWithoutTheWire) {
  Line line;
  line.ask(Instant{});
  const Duration wire = kLine.characters(8) + kLine.characters(7);
  (void)line.receive(kAnswer, Instant{wire + 5ms});
  EXPECT_NEAR(to_seconds(line.driver.response_time()), 0.005, 1e-6);
}

TEST(ExchangeDriver, AHeldResponseCountsWhenNothingFollows) {
  Line line;
  line.ask(Instant{});
  ASSERT_EQ(line.receive(kAnswer, Instant{20ms}), Outcome::kDone);
  EXPECT_FALSE(line.driver.holds());
  line.driver.hold(Outcome::kDone, Instant{30ms});
  EXPECT_TRUE(line.driver.holds());
  EXPECT_EQ(line.driver.deadline(), Instant{30ms});
  EXPECT_EQ(line.driver.on_timer(Instant{30ms}, line.out), Outcome::kDone);
  EXPECT_FALSE(line.driver.holds());
  EXPECT_EQ(line.driver.responded(), Instant{20ms});
  EXPECT_EQ(line.driver.exchange().reply().front().items, (Bytes{0x00, 0x2A}));
}

TEST(ExchangeDriver, TheResponseMayBeBehindAnotherFrame) {
  Line line;
  line.ask(Instant{});
  Bytes both = kAnswer;
  append(both, *from_hex("01 03 02 00 2B F8 5B"));
  ASSERT_EQ(line.receive(both, Instant{20ms}), Outcome::kDone);
  auto again = line.protocol->begin(ReadRequest{{{2, 100, 1}}}, {1});
  EXPECT_EQ(line.driver.wait_on(std::move(again), kAnswer.size(), Instant{20ms}, line.out),
            Outcome::kDone);
  EXPECT_EQ(line.driver.exchange().reply().front().items, (Bytes{0x00, 0x2B}));
  EXPECT_EQ(line.driver.bytes_received(), both.size());
}

TEST(ExchangeDriver, WithoutOtherBytesTheWaitForTheResponseContinues) {
  Line line;
  line.ask(Instant{});
  const Instant deadline = line.driver.deadline();
  ASSERT_EQ(line.receive(kAnswer, Instant{20ms}), Outcome::kDone);
  line.driver.hold(Outcome::kDone, Instant{30ms});
  auto again = line.protocol->begin(ReadRequest{{{2, 100, 1}}}, {1});
  EXPECT_EQ(line.driver.wait_on(std::move(again), kAnswer.size(), Instant{20ms}, line.out),
            Outcome::kWaiting);
  EXPECT_FALSE(line.driver.holds());
  EXPECT_EQ(line.driver.deadline(), deadline);
}

TEST(ExchangeDriver, ReturnsWhatTheResponseLacks) {
  Line line;
  line.ask(Instant{});
  EXPECT_EQ(line.driver.missing(), 0u) << "when the answer begins is not known";
  (void)line.receive({kAnswer.begin(), kAnswer.begin() + 3}, Instant{20ms});
  EXPECT_EQ(line.driver.missing(), 4u);
  (void)line.receive({kAnswer.begin() + 3, kAnswer.end() - 1}, Instant{21ms});
  EXPECT_EQ(line.driver.missing(), 1u);
  EXPECT_EQ(line.receive({kAnswer.end() - 1, kAnswer.end()}, Instant{22ms}), Outcome::kDone);
  line.driver.finish();
  EXPECT_EQ(line.driver.missing(), 0u);
}

TEST(ExchangeDriver, SilenceEndsItAfterTheTimeout) {
  Line line;
  line.ask(Instant{});
  EXPECT_EQ(line.driver.deadline(), Instant{200ms} + kLine.characters(8));
  EXPECT_EQ(line.driver.on_timer(line.driver.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.driver.cause(), Cause::kNoResponse);
}

TEST(ExchangeDriver, BrokenResponseEndsSoonAfterItsWireTime) {
  Line line;
  line.ask(Instant{});
  Bytes broken = kAnswer;
  broken.back() ^= 1;
  EXPECT_EQ(line.receive(broken, Instant{20ms}), Outcome::kWaiting);
  EXPECT_LE(line.driver.deadline(), Instant{50ms});
  EXPECT_EQ(line.driver.on_timer(line.driver.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.driver.cause(), Cause::kChecksum);
}

TEST(ExchangeDriver, BabbleCannotHoldTheWire) {
  Line line;
  line.ask(Instant{});
  Instant now{10ms};
  const Bytes noise{0x01, 0x03, 0x02};
  for (int i = 0; i < 10000 && now < line.driver.deadline(); ++i) {
    if (line.receive(noise, now) != Outcome::kWaiting) break;
    now += 1ms;
  }
  EXPECT_LT(now, Instant{300ms});
}

TEST(ExchangeDriver, EchoIsLearnedFromARead) {
  Line line(Echo::kUnknown);
  line.ask(Instant{});
  EXPECT_EQ(line.receive(kRequest, Instant{5ms}), Outcome::kWaiting);
  EXPECT_EQ(line.driver.echo(), Echo::kPresent);
  EXPECT_EQ(line.receive(kAnswer, Instant{20ms}), Outcome::kDone);
}

TEST(ExchangeDriver, EchoAndResponseInOnePieceAreDistinguished) {
  Line line(Echo::kUnknown);
  line.ask(Instant{});
  Bytes both = kRequest;
  append(both, kAnswer);
  EXPECT_EQ(line.receive(both, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.driver.echo(), Echo::kPresent);
}

TEST(ExchangeDriver, AResponseWithoutEchoShowsThatThereIsNone) {
  Line line(Echo::kUnknown);
  line.ask(Instant{});
  EXPECT_EQ(line.receive(kAnswer, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.driver.echo(), Echo::kAbsent);
}

TEST(ExchangeDriver, EchoOfAWriteIsNotAResponse) {
  Line line(Echo::kPresent);
  line.ask(Instant{}, WriteRequest{{2, 100, 1}, {0x00, 0x05}, {}, false}, EqualBytes::kResponse);
  const Bytes sent = line.out;
  EXPECT_EQ(line.receive(sent, Instant{5ms}), Outcome::kWaiting);
  EXPECT_EQ(line.driver.on_timer(line.driver.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.driver.cause(), Cause::kNoResponse);
}

TEST(ExchangeDriver, SecondCopyOfAWriteIsTheResponse) {
  Line line(Echo::kPresent);
  line.ask(Instant{}, WriteRequest{{2, 100, 1}, {0x00, 0x05}, {}, false}, EqualBytes::kResponse);
  const Bytes sent = line.out;
  EXPECT_EQ(line.receive(sent, Instant{5ms}), Outcome::kWaiting);
  EXPECT_EQ(line.receive(sent, Instant{20ms}), Outcome::kDone);
}

TEST(ExchangeDriver, ARefusalShowsWhetherTheLineEchoes) {
  const Bytes refusal{0x01, 0x90, 0x01, 0x8D, 0xC0};
  const WriteRequest distinct{{2, 100, 1}, {0x00, 0x05}, {}, true};
  Line silent(Echo::kUnknown);
  silent.ask(Instant{}, distinct);
  EXPECT_EQ(silent.receive(refusal, Instant{20ms}), Outcome::kFailed);
  EXPECT_EQ(silent.driver.echo(), Echo::kAbsent);
  Line echoing(Echo::kUnknown);
  echoing.ask(Instant{}, distinct);
  Bytes both = echoing.out;
  append(both, refusal);
  EXPECT_EQ(echoing.receive(both, Instant{20ms}), Outcome::kFailed);
  EXPECT_EQ(echoing.driver.echo(), Echo::kPresent);
}

TEST(ExchangeDriver, AResponseThatEqualsItsRequestTeachesNothing) {
  Line line(Echo::kUnknown);
  line.ask(Instant{}, WriteRequest{{2, 100, 1}, {0x00, 0x05}, {}, false}, EqualBytes::kResponse);
  const Bytes sent = line.out;
  EXPECT_EQ(line.receive({sent.begin(), sent.begin() + 3}, Instant{10ms}), Outcome::kWaiting);
  EXPECT_EQ(line.receive({sent.begin() + 3, sent.end()}, Instant{15ms}), Outcome::kDone);
  EXPECT_EQ(line.driver.echo(), Echo::kUnknown);
}

// A read of coils whose request is also a valid response.
const ReadRequest kDoubtfulRead{{{0, 768, 24}}};
const Bytes kDoubtfulRequest{0x01, 0x01, 0x03, 0x00, 0x00, 0x18, 0x3C, 0x44};

TEST(ExchangeDriver, BytesThatEqualADoubtfulReadAreNoResponse) {
  Line line(Echo::kUnknown);
  line.ask(Instant{}, kDoubtfulRead, EqualBytes::kDoubtful);
  EXPECT_EQ(line.out, kDoubtfulRequest);
  EXPECT_EQ(line.receive(kDoubtfulRequest, Instant{10ms}), Outcome::kWaiting);
  EXPECT_EQ(line.driver.on_timer(line.driver.deadline(), line.out), Outcome::kFailed);
  EXPECT_EQ(line.driver.cause(), Cause::kNoResponse);
  EXPECT_EQ(line.driver.echo(), Echo::kUnknown);
  // A read of another size finds that there is no echo; then the same bytes are the response.
  line.ask(Instant{300ms});
  EXPECT_EQ(line.receive(kAnswer, Instant{320ms}), Outcome::kDone);
  line.ask(Instant{400ms}, kDoubtfulRead);
  EXPECT_EQ(line.receive(kDoubtfulRequest, Instant{410ms}), Outcome::kDone);
}

TEST(ExchangeDriver, AResponseBehindTheEchoOfADoubtfulReadShowsTheEcho) {
  Line line(Echo::kUnknown);
  line.ask(Instant{}, kDoubtfulRead, EqualBytes::kDoubtful);
  EXPECT_EQ(line.receive(kDoubtfulRequest, Instant{10ms}), Outcome::kWaiting);
  EXPECT_EQ(line.receive(kDoubtfulRequest, Instant{20ms}), Outcome::kDone);
  EXPECT_EQ(line.driver.echo(), Echo::kPresent);
}

TEST(ExchangeDriver, AsManyBytesAsTheBufferHoldsAreReceived) {
  Line line;
  line.protocol = std::move(*find_protocol("mitsubishi-mc-serial")->make({0, {}}));
  line.ask(Instant{}, ReadRequest{{{0, 100, 1}}});
  const Bytes noise(ExchangeDriver::kMaxReceived, 0x55);
  EXPECT_EQ(line.receive(noise, Instant{20ms}), Outcome::kWaiting);
  EXPECT_EQ(line.receive({0x55}, Instant{20ms}), Outcome::kFailed);
  EXPECT_EQ(line.driver.cause(), Cause::kOverlong);
}

TEST(ExchangeDriver, EndlessBytesFailAsOverlong) {
  Line line;
  line.ask(Instant{});
  const Bytes flood(ExchangeDriver::kMaxReceived + 1, 0x55);
  EXPECT_EQ(line.receive(flood, Instant{20ms}), Outcome::kFailed);
  EXPECT_EQ(line.driver.cause(), Cause::kOverlong);
}

}  // namespace
}  // namespace fieldcast

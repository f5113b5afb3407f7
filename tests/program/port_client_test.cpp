#include "core/program/port_client.hpp"

#include <gmock/gmock.h>

#include <random>

#include "core/program/engineer.hpp"

namespace fieldcast::program {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Bench {
  explicit Bench(PortClientRules rules) : client(std::move(rules)) {}
  void tell(const PortClient::Event& event) {
    PortClient::Actions actions;
    client.on_event(event, now, actions);
    for (auto& action : actions) {
      if (auto* to = std::get_if<PortClient::ToBridge>(&action)) append(bridge, to->bytes);
      if (auto* to = std::get_if<PortClient::ToProgram>(&action)) append(program, to->bytes);
      if (auto* timer = std::get_if<PortClient::SetTimer>(&action)) wake = timer->at;
      if (auto* finish = std::get_if<PortClient::Finish>(&action)) end = finish->end;
      if (std::holds_alternative<PortClient::Dropped>(action)) ++dropped;
    }
  }
  void receives(std::string_view text) { tell(PortClient::FromBridge{as_bytes(text)}); }
  void pass(Duration time) {
    const Instant until = now + time;
    while (wake <= until) {
      now = std::max(now, wake);
      wake = kNever;
      tell(PortClient::TimerFired{});
    }
    now = until;
  }
  std::string sent() { return std::string(as_text(std::exchange(bridge, {}))); }

  Instant now{seconds{1000}};
  Instant wake = kNever;
  PortClient client;
  Bytes bridge, program;
  std::optional<PortEnd> end;
  int dropped = 0;
};

PortClientRules markers() {
  PortClientRules rules;
  rules.number = "17";
  rules.by_length = false;
  return rules;
}

TEST(PortClient, AsksForItsDeviceAndCarriesInstructions) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  EXPECT_EQ(b.sent(), "@@17FEFF");
  b.receives("@@0000FE");
  EXPECT_FALSE(b.client.paired());
  b.receives("FF@@@00first*\rFEFF");
  EXPECT_TRUE(b.client.paired());
  EXPECT_EQ(as_text(b.program), "@00first*\r");
  b.tell(PortClient::FromProgram{as_bytes("@00RD*\r@00")});
  EXPECT_EQ(b.sent(), "@@@00RD*\rFEFF");
  b.pass(milliseconds{2001});
  EXPECT_EQ(b.dropped, 1);
  EXPECT_EQ(b.client.bytes_from_device(), 10u);
  EXPECT_EQ(b.client.bytes_to_device(), 10u);
}

TEST(PortClient, ALoginGoesAheadOfTheRequest) {
  PortClientRules rules;
  rules.number = "17";
  rules.user = "anna";
  rules.password = "secret";
  Bench b(rules);
  b.tell(PortClient::Connected{});
  EXPECT_EQ(b.sent(), "@@AU616e6e61:736563726574FEFF@@V217FEFF");
}

TEST(PortClient, ARefusalEndsItWithItsReply) {
  for (const Reply reply : {Reply::kNotOnline, Reply::kInUse, Reply::kLost, Reply::kNotAllowed}) {
    Bench b(markers());
    b.tell(PortClient::Connected{});
    b.tell(PortClient::FromBridge{control_frame(to_code(reply))});
    ASSERT_TRUE(b.end);
    EXPECT_EQ(b.end->kind, PortEnd::Kind::kRefused);
    EXPECT_EQ(b.end->reply, reply);
  }
}

Bytes settings(const LineSettings& line) {
  Bytes out;
  append_settings(out, line);
  return out;
}

TEST(PortClient, TheFormatThatIsGivenGoesAheadOfTheFirstByteAndWithEverySpeed) {
  PortClientRules rules;
  rules.number = "17";
  rules.format = LineFormat{19200, 7, Parity::kEven, 2};
  Bench b(rules);
  b.tell(PortClient::Connected{});
  (void)b.sent();
  b.receives("@@0000FEFF");
  EXPECT_EQ(std::exchange(b.bridge, {}), settings({0, 2, 7, Parity::kEven}));
  b.tell(PortClient::LineChanged{{115200, 1}});
  EXPECT_EQ(std::exchange(b.bridge, {}), settings({115200, 2, 7, Parity::kEven}));
}

TEST(PortClient, ABaudRateThatIsGivenReplacesThatOfTheProgram) {
  PortClientRules rules;
  rules.number = "17";
  rules.format = LineFormat{19200, 7, Parity::kEven, 2};
  rules.baud = 9600;
  Bench b(rules);
  b.tell(PortClient::Connected{});
  (void)b.sent();
  b.receives("@@0000FEFF");
  EXPECT_EQ(std::exchange(b.bridge, {}), settings({9600, 2, 7, Parity::kEven}));
  b.tell(PortClient::LineChanged{{115200, 1}});
  EXPECT_EQ(std::exchange(b.bridge, {}), settings({9600, 2, 7, Parity::kEven}));
}

TEST(PortClient, WithoutAFormatOnlyWhatTheVirtualPortReportsIsCarried) {
  PortClientRules rules;
  rules.number = "17";
  Bench b(rules);
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF");
  (void)b.sent();
  b.tell(PortClient::LineChanged{{115200, 2}});
  EXPECT_EQ(std::exchange(b.bridge, {}), settings({115200, 2, 0, Parity::kNone}));
}

TEST(PortClient, ARefusedLoginIsSaidWithItsUser) {
  PortClientRules named = markers();
  named.user = "anna";
  Bench with(named), without(markers());
  for (Bench* b : {&with, &without}) {
    b->tell(PortClient::Connected{});
    b->tell(PortClient::FromBridge{control_frame("0004")});
    ASSERT_TRUE(b->end);
  }
  EXPECT_THAT(with.end->text,
              testing::HasSubstr("the login of anna is refused: a wrong password, another role"));
  EXPECT_THAT(without.end->text,
              testing::HasSubstr("a login of a user with the role programmer is needed"));
}

TEST(PortClient, TheEndOfTheDeviceOfTheBridgeAndOfTheUserAreReported) {
  Bench lost(markers()), gone(markers()), stopped(markers());
  for (Bench* b : {&lost, &gone, &stopped}) {
    b->tell(PortClient::Connected{});
    b->receives("@@0000FEFF");
    (void)b->sent();
  }
  lost.receives("@@0003FEFF");
  lost.pass(milliseconds{201});  // an instruction could begin so
  EXPECT_EQ(lost.end->kind, PortEnd::Kind::kDeviceLost);
  gone.tell(PortClient::BridgeGone{"reset"});
  EXPECT_EQ(gone.end->kind, PortEnd::Kind::kBridgeGone);
  stopped.tell(PortClient::StopAsked{});
  EXPECT_EQ(stopped.end->kind, PortEnd::Kind::kStopped);
  EXPECT_EQ(stopped.sent(), "@@EDFEFF");
}

TEST(PortClient, ABridgeThatFallsSilentHasLeft) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF");
  b.pass(seconds{16});
  EXPECT_FALSE(b.end);
  EXPECT_THAT(b.sent(), testing::HasSubstr("@@HBFEFF@@HBFEFF@@HBFEFF"));
  b.receives("@@HBFEFF");
  b.pass(seconds{17});
  EXPECT_FALSE(b.end);
  b.pass(seconds{1});
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kBridgeGone);
}

TEST(PortClient, AHeartbeatOfTheBridgeGetsAResponse) {
  PortClientRules lengths;
  lengths.number = "17";
  Bench b(markers()), v2(lengths);
  for (Bench* bench : {&b, &v2}) {
    bench->tell(PortClient::Connected{});
    bench->receives("@@0000FEFF");
    (void)bench->sent();
  }
  b.receives("@@HBFEFF");
  EXPECT_EQ(b.sent(), "@@HBFEFF");
  v2.tell(PortClient::FromBridge{Bytes{0, 0, 0, 0}});
  EXPECT_EQ(v2.sent(), std::string(4, '\0'));
}

TEST(PortClient, ABridgeThatNeverRespondsIsGivenUp) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.pass(seconds{31});
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kBridgeGone);
}

TEST(PortClient, WhatIsNotABridgeIsReported) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.receives("SSH-2.0-OpenSSH_9.2\r\n");
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kProtocol);
}

TEST(PortClient, AContinuationThatBeginsLikeTheLossOfTheDeviceIsProgramBytes) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF@@0003FEFF");
  EXPECT_FALSE(b.end);
  b.receives("12*\rFEFF@@0000FEFF34*\rFEFF");
  EXPECT_EQ(as_text(b.program), "0003FEFF12*\r0000FEFF34*\r");
  b.receives("@@0003FEFF");
  EXPECT_FALSE(b.end);
  b.pass(milliseconds{201});
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kDeviceLost);
}

TEST(PortClient, ABridgeThatReportsTheLossAndClosesHasReportedIt) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF@@0003FEFF");
  b.tell(PortClient::BridgeGone{"closed by the peer"});
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kDeviceLost);
}

TEST(PortClient, WhileTheProgramTakesNothingNoHeartbeatIsMissed) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF");
  b.tell(PortClient::ProgramTakes{false});
  b.pass(seconds{120});
  EXPECT_FALSE(b.end);
  b.tell(PortClient::ProgramTakes{true});
  b.pass(seconds{17});
  EXPECT_FALSE(b.end);
  b.pass(seconds{1});
  EXPECT_TRUE(b.end);
}

Bytes piece(Bytes& stream, std::mt19937& random) {
  const std::size_t count = std::min<std::size_t>(stream.size(), 1 + random() % 50);
  Bytes out(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(count));
  stream.erase(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(count));
  return out;
}

// A client and the bridge's end, connected by two streams; the device does not echo.
TEST(PortClient, BothEndsCarryEveryByteBothWaysHoweverTheStreamIsCut) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    PortClientRules rules;
    rules.number = "17";
    rules.by_length = seed % 2 == 0;
    Bench b(rules);
    Engineer engineer(EngineerRules{}, b.now);
    Bytes to_engineer, to_client, at_device, at_program, down, up;
    for (Bytes* side : {&down, &up}) {
      for (int i = 0; i < 2000; ++i)
        side->push_back(rules.by_length ? static_cast<std::uint8_t>(random())
                                        : "@@FE\r*0"[random() % 7]);
      side->push_back('\r');
    }
    std::size_t refused = 0;
    const auto run = [&](const EngineerEvent& event) {
      EngineerActions actions;
      engineer.on_event(event, b.now, actions);
      for (auto& action : actions) {
        if (auto* to = std::get_if<ToClient>(&action)) append(to_client, to->bytes);
        if (auto* to = std::get_if<ToDevice>(&action)) append(at_device, to->bytes);
        if (std::holds_alternative<TakeDevice>(action)) ++refused;
      }
    };
    b.tell(PortClient::Connected{});
    append(to_engineer, std::exchange(b.bridge, {}));
    Bytes left_down = down, left_up = up;
    for (int step = 0;
         step < 20'000 && (at_device.size() < down.size() || b.program.size() < up.size());
         ++step) {
      switch (random() % 4) {
        case 0:
          if (!to_engineer.empty()) run(FromClient{piece(to_engineer, random)});
          if (refused == 1) run(DeviceGiven{}), ++refused;
          break;
        case 1:
          if (!to_client.empty()) b.tell(PortClient::FromBridge{piece(to_client, random)});
          break;
        case 2:
          if (b.client.paired() && !left_down.empty())
            b.tell(PortClient::FromProgram{piece(left_down, random)});
          append(to_engineer, std::exchange(b.bridge, {}));
          break;
        default:
          if (engineer.paired() && !left_up.empty()) run(FromDevice{piece(left_up, random)});
      }
    }
    EXPECT_EQ(at_device, down) << seed;
    EXPECT_EQ(b.program, up) << seed;
  }
}

TEST(SlowPath, IsReportedWithItsTime) {
  EXPECT_EQ(slow_path_text(std::chrono::microseconds{49'999}), "");
  EXPECT_EQ(slow_path_text(std::chrono::microseconds{301'400}),
            "the network adds 301ms to each response: if the software reports timeouts, set a "
            "longer response timeout in it");
}

PortClientRules by_length() {
  PortClientRules rules;
  rules.number = "17";
  return rules;
}

TEST(PortClient, WithFramingByLengthAStopIsTheLossOfTheDevice) {
  Bench b(by_length());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF");
  Bytes stream;
  append_chunks(stream, as_bytes("last"));
  append(stream, stop_frame(true));
  b.tell(PortClient::FromBridge{stream});
  EXPECT_EQ(as_text(b.program), "last");
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kDeviceLost);
  EXPECT_EQ(b.end->text, to_text(Reply::kLost));
}

TEST(PortClient, AnInvalidLengthIsAFaultOfTheBridge) {
  Bench b(by_length());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF@@17");  // 40403137h bytes
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kProtocol);
  EXPECT_TRUE(b.program.empty());
}

TEST(PortClient, WithFramingByLengthAClosedConnectionIsTheEndOfTheBridge) {
  Bench b(by_length());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF");
  b.tell(PortClient::BridgeGone{"reset"});
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kBridgeGone);
  EXPECT_EQ(b.end->text, "reset");
}

TEST(PortClient, BeforeItIsPairedItSendsNothingButItsRequest) {
  Bench b(by_length());
  b.tell(PortClient::Connected{});
  (void)b.sent();
  b.tell(PortClient::LineChanged{{9600, 1}});
  b.tell(PortClient::FromProgram{as_bytes("early")});
  b.receives("@@HBFEFF@@17FEFF");  // a heartbeat and a code that is not a reply
  b.tell(PortClient::TimerFired{});
  EXPECT_FALSE(b.end);
  b.tell(PortClient::StopAsked{});
  EXPECT_EQ(b.sent(), "");
  ASSERT_TRUE(b.end);
  EXPECT_EQ(b.end->kind, PortEnd::Kind::kStopped);
}

TEST(PortClient, AfterItsEndNothingIsSentOrReported) {
  Bench b(by_length());
  b.tell(PortClient::Connected{});
  b.tell(PortClient::BridgeGone{"reset"});
  (void)b.sent();
  b.end.reset();
  b.receives("@@0000FEFF");
  b.tell(PortClient::StopAsked{});
  EXPECT_FALSE(b.end);
  EXPECT_EQ(b.sent(), "");
}

TEST(PortClient, FramingByMarkersHasNoLineSettings) {
  PortClientRules rules = markers();
  rules.format = LineFormat{19200, 7, Parity::kEven, 2};
  Bench b(rules);
  b.tell(PortClient::Connected{});
  (void)b.sent();
  b.receives("@@0000FEFF");
  b.tell(PortClient::LineChanged{{115200, 1}});
  EXPECT_EQ(b.sent(), "");
}

TEST(PortClient, DroppedDataIsReportedInBothDirections) {
  Bench b(markers());
  b.tell(PortClient::Connected{});
  b.receives("@@0000FEFF");
  (void)b.sent();
  b.receives("noise@@ok\rFEFF");
  EXPECT_EQ(b.dropped, 1);
  EXPECT_EQ(as_text(b.program), "ok\r");
  b.tell(PortClient::FromProgram{as_bytes(std::string(kMaxInstruction, 'x') + "\rnext\r")});
  EXPECT_EQ(b.dropped, 2);
  EXPECT_EQ(b.sent(), "@@next\rFEFF");
  b.receives("@@half");
  b.pass(milliseconds{2001});
  EXPECT_EQ(b.dropped, 3);
  EXPECT_FALSE(b.end);
}

}  // namespace
}  // namespace fieldcast::program

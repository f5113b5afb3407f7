#include "core/telnet/options.hpp"

#include "tests/telnet/frames.hpp"

namespace fieldcast::telnet {
namespace {

std::string respond(Options& options, Code verb, std::uint8_t option) {
  Bytes out;
  options.on_request({verb, option}, out);
  return to_hex(out);
}

TEST(TelnetOptions, AcceptsAKnownOptionOnceAndRefusesOthers) {
  Options options(End::kThere);
  EXPECT_EQ(respond(options, Code::kWill, kBinary), "FF FD 00");  // DO BINARY
  EXPECT_EQ(respond(options, Code::kWill, kBinary), "");          // already enabled
  EXPECT_TRUE(options.enabled(kBinary, End::kThere));
  EXPECT_FALSE(options.enabled(kBinary, End::kHere));
  EXPECT_EQ(respond(options, Code::kDo, 31), "FF FC 1F");    // WONT NAWS
  EXPECT_EQ(respond(options, Code::kWill, 24), "FF FE 18");  // DONT TERMINAL-TYPE
  EXPECT_EQ(respond(options, Code::kDont, 31), "");
}

TEST(TelnetOptions, OneEndEchoes) {
  Options client(End::kThere), server(End::kHere);
  EXPECT_EQ(respond(client, Code::kDo, kEcho), "FF FC 01");  // WONT
  EXPECT_EQ(respond(server, Code::kDo, kEcho), "FF FB 01");  // WILL
}

TEST(TelnetOptions, AResponseToARequestGetsNoResponse) {
  Options options(End::kThere);
  Bytes out;
  options.request(kComPort, End::kHere, out);
  options.request(kComPort, End::kHere, out);
  EXPECT_EQ(to_hex(out), "FF FB 2C");  // WILL, once
  EXPECT_EQ(respond(options, Code::kDo, kComPort), "");
  EXPECT_TRUE(options.enabled(kComPort, End::kHere));
  EXPECT_EQ(respond(options, Code::kDont, kComPort), "FF FC 2C");  // WONT
  EXPECT_TRUE(options.refused(kComPort, End::kHere));
}

TEST(TelnetOptions, TwoEndsThatRequestTheSameAgreeWithoutALoop) {
  Options here(End::kThere), there(End::kHere);
  Bytes to_there, to_here;
  for (const auto option : {kBinary, kSuppressGoAhead, kComPort}) {
    for (const End end : {End::kHere, End::kThere}) {
      here.request(option, end, to_there);
      there.request(option, end, to_here);
    }
  }
  int rounds = 0;
  const auto deliver = [](Options& to, Bytes& bytes, Bytes& back) {
    Parser parser;
    const Bytes sent = std::exchange(bytes, {});
    ByteView in = sent;
    while (const auto item = parser.next(in)) to.on_request(std::get<OptionRequest>(*item), back);
  };
  for (; !to_there.empty() || !to_here.empty(); ++rounds) {
    ASSERT_LT(rounds, 3);
    Bytes next_here, next_there;
    deliver(there, to_there, next_here);
    deliver(here, to_here, next_there);
    to_here = next_here, to_there = next_there;
  }
  EXPECT_EQ(rounds, 1);  // each request was the consent to the other
  for (const End end : {End::kHere, End::kThere}) {
    EXPECT_TRUE(here.enabled(kComPort, end));
    EXPECT_TRUE(there.enabled(kBinary, end));
  }
}

TEST(TelnetOptions, APeerThatNeverStopsGetsNoMoreResponses) {
  Options options(End::kThere);
  std::size_t responses = 0;
  for (unsigned i = 0; i < 10'000; ++i) {
    responses += respond(options, Code::kWill, 99).empty() ? 0 : 1;
    responses += respond(options, i % 2 == 0 ? Code::kDo : Code::kDont, kBinary).empty() ? 0 : 1;
  }
  EXPECT_EQ(responses, Options::kMaxResponses);
}

TEST(TelnetOptions, OnlyKnownOptionsAreRequestedAndOnlyARequestIsRefused) {
  Options options(End::kThere);
  Bytes out;
  options.request(31, End::kHere, out);  // NAWS
  EXPECT_EQ(to_hex(out), "");
  EXPECT_FALSE(options.enabled(31, End::kHere));
  EXPECT_FALSE(options.refused(31, End::kHere));
  EXPECT_EQ(respond(options, Code::kDont, kBinary), "");  // BINARY is off
  EXPECT_FALSE(options.refused(kBinary, End::kHere));
}

}  // namespace
}  // namespace fieldcast::telnet

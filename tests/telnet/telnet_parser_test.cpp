#include <numeric>

#include "core/telnet/telnet.hpp"
#include "tests/telnet/frames.hpp"

namespace fieldcast::telnet {
namespace {

struct Read {
  Bytes data;
  std::string marks;  // "will 44", "sub 44: 01 02"
  std::uint64_t dropped = 0;
  friend bool operator==(const Read&, const Read&) = default;
};

Read read(ByteView stream, std::size_t piece) {
  Parser parser;
  Read read;
  while (!stream.empty()) {
    ByteView in = stream.first(std::min(piece, stream.size()));
    stream = stream.subspan(in.size());
    while (const auto item = parser.next(in)) {
      if (const auto* data = std::get_if<Data>(&*item)) append(read.data, data->bytes);
      if (const auto* request = std::get_if<OptionRequest>(&*item))
        read.marks += "option " + std::to_string(static_cast<int>(request->verb)) + ' ' +
                      std::to_string(request->option) + '\n';
      if (const auto* sub = std::get_if<Subnegotiation>(&*item))
        read.marks += "sub " + std::to_string(sub->option) + ": " + to_hex(sub->bytes) + '\n';
    }
    EXPECT_TRUE(in.empty());
  }
  read.dropped = parser.dropped();
  return read;
}

TEST(TelnetParser, EverySplitGivesTheSame) {
  const Bytes stream = together({"41 FF FF FF FF 42",              // A, FF, FF, B
                                 "FF FB 2C",                       // WILL COM-PORT-OPTION
                                 "FF F1",                          // NOP
                                 "FF FA 2C 01 00 FF FF 00 FF F0",  // a value with FF
                                 "FF F6 43"});                     // AYT, C
  const Read expected{{0x41, 0xFF, 0xFF, 0x42, 0x43}, "option 251 44\nsub 44: 01 00 FF 00\n", 0};
  for (std::size_t piece = 1; piece <= stream.size(); ++piece)
    ASSERT_EQ(read(stream, piece), expected) << piece;
}

TEST(TelnetParser, ReadsBackAllBytesThatWereEscaped) {
  Bytes data(512);
  std::iota(data.begin(), data.end(), std::uint8_t{0});
  Bytes stream;
  append_data(stream, data);
  EXPECT_EQ(stream.size(), 514u);
  EXPECT_EQ(read(stream, 7).data, data);
}

TEST(TelnetParser, DropsALongSubnegotiationAndContinues) {
  Bytes stream;
  append_subnegotiation(stream, 44, Bytes(Parser::kMaxSubnegotiation + 1));
  append_subnegotiation(stream, 44, Bytes(Parser::kMaxSubnegotiation));
  append_data(stream, Bytes{0x41});
  const Read got = read(stream, 1000);
  EXPECT_EQ(got.dropped, 1u);
  EXPECT_EQ(got.marks.substr(0, 7), "sub 44:");
  EXPECT_EQ(got.data, Bytes{0x41});
}

// RFC 855 requires IAC SE; a peer that lost it begins the next command.
TEST(TelnetParser, ACommandEndsAnOpenSubnegotiation) {
  const Read got = read(hex("FF FA 2C 01 FF FD 00 41"), 1);
  EXPECT_EQ(got, (Read{{0x41}, "option 253 0\n", 1}));
}

}  // namespace
}  // namespace fieldcast::telnet

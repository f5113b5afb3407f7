#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/program/frame.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast::program {
namespace {

struct Read {
  Bytes program;
  std::string marks;  // h heartbeat, s stop, l line settings, f fault
  std::vector<LineSettings> settings;
};

Read read_all(ByteView stream, std::size_t piece) {
  LengthReader reader;
  Read read;
  while (!stream.empty()) {
    ByteView in = stream.first(std::min(piece, stream.size()));
    stream = stream.subspan(in.size());
    while (const auto frame = reader.next(in)) {
      if (const auto* chunk = std::get_if<ChunkBytes>(&*frame)) append(read.program, chunk->bytes);
      if (std::holds_alternative<Heartbeat>(*frame)) read.marks += 'h';
      if (std::holds_alternative<Stop>(*frame)) read.marks += 's';
      if (const auto* line = std::get_if<LineSettings>(&*frame))
        read.marks += 'l', read.settings.push_back(*line);
      if (std::holds_alternative<FrameFault>(*frame)) return read.marks += 'f', read;
    }
    EXPECT_TRUE(in.empty());
  }
  return read;
}

TEST(LengthFraming, IsAsTheChapterSays) {
  Bytes out;
  append_chunks(out, Bytes{0xAB, 0xCD});
  append(out, heartbeat_frame(true));
  append(out, stop_frame(true));
  EXPECT_EQ(to_hex(out), "00 00 00 02 AB CD 00 00 00 00 FF FF FF FF");
}

TEST(LengthFraming, EverySplitGivesTheSame) {
  Bytes program(300);
  std::mt19937 random(3);
  for (auto& byte : program) byte = static_cast<std::uint8_t>(random());
  Bytes stream;
  append(stream, heartbeat_frame(true));
  append_settings(stream, {115200, 2, 7, Parity::kEven});
  append_chunks(stream, program);
  append(stream, heartbeat_frame(true));
  append(stream, stop_frame(true));
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    const Read read = read_all(stream, piece);
    ASSERT_EQ(read.program, program) << piece;
    ASSERT_EQ(read.marks, "hlhs") << piece;
    ASSERT_EQ(read.settings, (std::vector{LineSettings{115200, 2, 7, Parity::kEven}})) << piece;
  }
}

TEST(LengthFraming, AllByteValuesPass) {
  for (const auto& vector : test::load_vectors("tunnel")) {
    if (vector.name != "all_byte_values") continue;
    for (const Bytes& side : {vector.request, vector.response}) {
      ASSERT_EQ(side.size(), 1024u);
      Bytes stream;
      append_chunks(stream, side);
      EXPECT_EQ(read_all(stream, 64).program, side);
    }
    return;
  }
  FAIL() << "no such vector";
}

TEST(LengthFraming, LongBytesAreCutIntoChunks) {
  const Bytes program(3 * kMaxChunk + 5, 7);
  Bytes stream;
  append_chunks(stream, program);
  EXPECT_EQ(stream.size(), program.size() + 4 * 4);
  EXPECT_EQ(read_all(stream, 10'000).program, program);
}

TEST(LengthFraming, ALengthThatNobodySendsIsALostStream) {
  Bytes stream;
  append_u32(stream, kMaxChunk + 1);
  EXPECT_EQ(read_all(stream, 1).marks, "f");
  stream.clear();
  append_u32(stream, 0xFFFF'FFFD);
  EXPECT_EQ(read_all(stream, 4).marks, "f");
}

TEST(LengthFraming, LineSettingsThatNobodySendsAreALostStream) {
  for (const LineSettings& bad :
       {LineSettings{9600, 0, 8, Parity::kNone}, LineSettings{9600, 1, 9, Parity::kNone},
        LineSettings{9600, 1, 8, static_cast<Parity>(3)}}) {
    Bytes stream;
    append_settings(stream, bad);
    ByteView in = stream;
    LengthReader reader;
    const auto frame = reader.next(in);
    ASSERT_TRUE(frame && std::holds_alternative<FrameFault>(*frame));
    EXPECT_EQ(std::get<FrameFault>(*frame), FrameFault::kBadLine);
  }
}

TEST(LengthFraming, HalfAHeadOrChunkIsPartial) {
  Bytes stream;
  append_chunks(stream, Bytes{1, 2});
  for (std::size_t cut = 1; cut < stream.size(); ++cut) {
    LengthReader reader;
    ByteView in = ByteView(stream).first(cut);
    while (reader.next(in)) {}
    EXPECT_TRUE(reader.partial()) << cut;
  }
}

TEST(LengthFraming, AfterAWholeFrameNothingIsPartial) {
  LengthReader reader;
  EXPECT_FALSE(reader.partial());
  const Bytes stream = heartbeat_frame(true);
  ByteView in = stream;
  ASSERT_TRUE(reader.next(in));
  EXPECT_FALSE(reader.partial());
}

TEST(Frames, RepliesHaveFourDigits) {
  for (const Reply reply :
       {Reply::kPaired, Reply::kNotOnline, Reply::kInUse, Reply::kLost, Reply::kNotAllowed})
    EXPECT_EQ(reply_from(to_code(reply)), reply);
  for (const char* code : {"", "000", "00000", "0005", "000/", "1000", "0010"})
    EXPECT_EQ(reply_from(code), std::nullopt) << code;
}

TEST(Frames, EachReplyAndFaultHasItsText) {
  using testing::HasSubstr;
  EXPECT_EQ(to_text(Reply::kPaired), "paired");
  EXPECT_EQ(to_text(Reply::kLost), "the device went offline, or was taken back");
  EXPECT_EQ(to_text(static_cast<Reply>(9)), "?");
  EXPECT_THAT(to_text(FrameFault::kNoise), HasSubstr("outside of any frame"));
  EXPECT_THAT(to_text(FrameFault::kTooLong), HasSubstr("more than 4096 characters"));
  EXPECT_THAT(to_text(FrameFault::kHalf), HasSubstr("did not come within 2 s"));
  EXPECT_THAT(to_text(FrameFault::kAmbiguous), HasSubstr("begins like a control frame"));
  EXPECT_EQ(to_text(FrameFault::kBadLength), "a length that no client sends");
  EXPECT_EQ(to_text(FrameFault::kBadLine), "line settings that no client sends");
  EXPECT_EQ(to_text(static_cast<FrameFault>(99)), "?");
}

}  // namespace
}  // namespace fieldcast::program

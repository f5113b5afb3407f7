#include "core/program/marker_framing.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/vectors.hpp"

namespace fieldcast::program {
namespace {

using Phase = MarkerReader::Phase;

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

struct Read {
  Bytes program;
  std::vector<std::string> codes;
  std::vector<FrameFault> faults;
  std::vector<std::size_t> lost;
  void take(const MarkerFrame& frame) {
    if (const auto* code = std::get_if<ControlCode>(&frame)) codes.push_back(code->code);
    if (const auto* instruction = std::get_if<Instruction>(&frame))
      append(program, instruction->bytes);
    if (const auto* broken = std::get_if<BrokenFrame>(&frame)) {
      faults.push_back(broken->fault);
      lost.push_back(broken->bytes);
    }
  }
  void feed(MarkerReader& reader, ByteView bytes, Phase phase) {
    reader.feed(bytes);
    while (const auto frame = reader.next(phase)) take(*frame);
  }
};

Read read_all(ByteView stream, Phase phase = Phase::kTransmission, std::size_t piece = SIZE_MAX,
              Sender sender = Sender::kClient) {
  MarkerReader reader(sender);
  Read read;
  while (!stream.empty()) {
    const std::size_t count = std::min(piece, stream.size());
    read.feed(reader, stream.first(count), phase);
    stream = stream.subspan(count);
  }
  while (const auto code = reader.take_code()) {
    read.codes.push_back(code->code);
    read.feed(reader, {}, phase);
  }
  return read;
}

Bytes framed(ByteView program, Sender sender = Sender::kClient) {
  MarkerWriter writer(sender);
  Bytes out;
  EXPECT_TRUE(writer.write(program, out).empty());
  return out;
}

TEST(MarkerFraming, AFrameIsAsTheChapterSays) {
  EXPECT_EQ(as_text(framed(bytes_of("@00RD00000001*\r"))), "@@@00RD00000001*\rFEFF");
  EXPECT_EQ(as_text(control_frame("ED")), "@@EDFEFF");
}

TEST(MarkerFraming, ProgramBytesMayHoldTheMarkers) {
  const Bytes program = bytes_of("@00WD0000FEFFFEFF12*\r@@\rFEFF\r@\r@@EDFEF\r\r\rFEFF@@HB\r");
  EXPECT_EQ(read_all(framed(program)).program, program);
}

TEST(MarkerFraming, EverySplitOfTheStreamGivesTheSame) {
  const Bytes program = bytes_of("@00WD0000FEFF*\r@@FEF\rFEFF\r@\r\r");
  Bytes stream = control_frame("HB");
  append(stream, framed(program));
  append(stream, control_frame("ED"));
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    MarkerReader reader(Sender::kClient);
    Read read;
    read.feed(reader, ByteView(stream).first(cut), Phase::kTransmission);
    read.feed(reader, ByteView(stream).subspan(cut), Phase::kTransmission);
    EXPECT_EQ(reader.patience(), MarkerReader::kCodeWait) << cut;
    if (const auto last = reader.take_code()) read.codes.push_back(last->code);
    EXPECT_FALSE(reader.partial()) << cut;
    EXPECT_EQ(read.program, program) << cut;
    EXPECT_EQ(read.codes, (std::vector<std::string>{"HB", "ED"})) << cut;
    EXPECT_TRUE(read.faults.empty()) << cut;
  }
  const Read bytewise = read_all(stream, Phase::kTransmission, 1);
  EXPECT_EQ(bytewise.program, program);
  EXPECT_EQ(bytewise.codes.size(), 2u);
}

TEST(MarkerFraming, ACodeWaitsAShortTimeForWhatCouldFollowIt) {
  const auto patience = [](std::string_view text) {
    MarkerReader reader(Sender::kClient);
    Read().feed(reader, bytes_of(text), Phase::kTransmission);
    return reader.patience();
  };
  EXPECT_EQ(patience("@@EDFEFF"), MarkerReader::kCodeWait);
  EXPECT_EQ(patience("@@EDFEFF@"), MarkerReader::kCodeWait);
  EXPECT_EQ(patience("@@EDFEF"), MarkerReader::kHalfWait);
  EXPECT_EQ(patience("@@@00RD*\rFEF"), MarkerReader::kHalfWait);
  EXPECT_EQ(patience("no"), MarkerReader::kHalfWait);
}

// Uses an alphabet that makes markers likely.
TEST(MarkerFraming, RandomInstructionsComeBackByteForByte) {
  std::mt19937 random(7);
  static constexpr std::string_view kAlphabet = "@@@FFEE\r\rHBD03*\n\x11\xFF";
  for (int round = 0; round < 6000; ++round) {
    const Sender sender = round % 2 == 0 ? Sender::kClient : Sender::kBridge;
    Bytes program;
    for (auto length = random() % 60; length > 0; --length) {
      program.push_back(static_cast<std::uint8_t>(kAlphabet[random() % kAlphabet.size()]));
    }
    program.push_back('\r');
    MarkerWriter writer(sender);
    Bytes stream;
    const auto refused = writer.write(program, stream);
    std::size_t lost = 0;
    for (const BrokenFrame& broken : refused) {
      EXPECT_EQ(broken.fault, FrameFault::kAmbiguous);
      lost += broken.bytes;
    }
    const Read read = read_all(stream, Phase::kTransmission, 1 + random() % 7, sender);
    EXPECT_EQ(read.program.size() + lost, program.size());
    EXPECT_TRUE(read.codes.empty() && read.faults.empty());
    if (refused.empty()) { EXPECT_EQ(read.program, program); }
  }
}

// All frames of a long Host Link transfer but the first begin with any words.
TEST(MarkerFraming, AContinuationOfHostLinkMayBeginLikeAControlFrame) {
  for (const Sender sender : {Sender::kClient, Sender::kBridge}) {
    for (const char* code : {"0000", "0001", "0002", "0003", "0004", "ED"}) {
      const std::string first = code + std::string("FEFF");
      for (const std::string& words : {first + "1234FEFF5A\r", first + "\r", first + "@1*\r"}) {
        Bytes program = bytes_of("@00RD00");
        append(program, bytes_of(words + "0000FEFF5B*\r" + words));
        program.push_back('\r');
        const Bytes stream = framed(program, sender);
        for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
          const Read read = read_all(stream, Phase::kTransmission, piece, sender);
          EXPECT_EQ(as_text(read.program), as_text(program)) << piece;
          EXPECT_TRUE(read.codes.empty() && read.faults.empty()) << words << ' ' << piece;
        }
      }
    }
  }
}

TEST(MarkerFraming, WhatFollowsACodeReportsWhetherItIsOne) {
  using Codes = std::vector<std::string>;
  struct Case {
    Sender sender;
    std::string_view stream;
    Codes at_once, in_the_end;
    std::string_view program;
  };
  for (const Case& c : {
           Case{Sender::kClient, "@@EDFEFF", {}, {"ED"}, ""},
           Case{Sender::kClient, "@@EDFEFF@", {}, {"ED"}, ""},
           Case{Sender::kClient, "@@EDFEFF@@", {"ED"}, {"ED"}, ""},
           Case{Sender::kClient, "@@EDFEFF@@EDFEFF", {"ED"}, {"ED", "ED"}, ""},
           Case{Sender::kClient, "@@EDFEFF\rFEF", {}, {"ED"}, ""},
           Case{Sender::kClient, "@@EDFEFF\rFEFF", {}, {}, "EDFEFF\r"},
           Case{Sender::kClient, "@@EDFEFF\r\n", {"ED"}, {"ED"}, ""},  // typed by hand
           Case{Sender::kClient, "@@EDFEFF12", {}, {"ED"}, ""},
           Case{Sender::kClient, "@@HBFEFF", {"HB"}, {"HB"}, ""},
           Case{Sender::kClient, "@@0003FEFF@@", {}, {}, ""},
           Case{Sender::kBridge, "@@0003FEFF", {}, {"0003"}, ""},
           Case{Sender::kBridge, "@@0003FEFF@@HBFEFF", {"0003", "HB"}, {"0003", "HB"}, ""},
           Case{Sender::kBridge, "@@EDFEFF@@", {}, {}, ""},
       }) {
    MarkerReader reader(c.sender);
    Read read;
    read.feed(reader, as_bytes(c.stream), Phase::kTransmission);
    EXPECT_EQ(read.codes, c.at_once) << c.stream;
    EXPECT_EQ(as_text(read.program), c.program) << c.stream;
    EXPECT_EQ(read_all(as_bytes(c.stream), Phase::kTransmission, 1, c.sender).codes, c.in_the_end)
        << c.stream;
  }
}

TEST(MarkerFraming, AnInstructionThatIsAControlFrameAndMoreIsReportedNotMistaken) {
  const std::pair<Sender, const char*> instructions[] = {{Sender::kClient, "HBFEFF\r"},
                                                         {Sender::kClient, "EDFEFF@@12\r"},
                                                         {Sender::kClient, "EDFEFF1@@\r"},
                                                         {Sender::kBridge, "0003FEFF@@\r"}};
  for (const auto& [sender, instruction] : instructions) {
    MarkerWriter writer(sender);
    Bytes out;
    const auto lost = writer.write(bytes_of(instruction), out);
    ASSERT_EQ(lost.size(), 1u) << instruction;
    EXPECT_EQ(lost[0].fault, FrameFault::kAmbiguous);
    EXPECT_TRUE(out.empty());
  }
}

TEST(MarkerFraming, TheLongestInstructionPassesAndOneMoreIsReportedWhole) {
  Bytes longest(kMaxInstruction - 1, 'x');
  longest.push_back('\r');
  EXPECT_EQ(read_all(framed(longest), Phase::kTransmission, 100).program, longest);

  Bytes longer(kMaxInstruction, 'x');
  longer.push_back('\r');
  append(longer, bytes_of("next\r"));
  MarkerWriter writer(Sender::kClient);
  Bytes out;
  const auto lost = writer.write(longer, out);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].fault, FrameFault::kTooLong);
  EXPECT_EQ(lost[0].bytes, kMaxInstruction + 1);
  EXPECT_EQ(as_text(out), "@@next\rFEFF");
}

TEST(MarkerFraming, AReaderDropsAnInstructionThatIsTooLongWholeAndGoesOn) {
  for (const std::size_t piece :
       {std::size_t{1}, std::size_t{3}, std::size_t{1000}, std::size_t{100'000}}) {
    Bytes stream = bytes_of("@@");
    stream.insert(stream.end(), 3 * kMaxInstruction, 'x');
    append(stream, bytes_of("\rFEFF@@next\rFEFF"));
    const Read read = read_all(stream, Phase::kTransmission, piece);
    EXPECT_EQ(as_text(read.program), "next\r") << piece;
    EXPECT_EQ(read.faults, std::vector<FrameFault>{FrameFault::kTooLong}) << piece;
    EXPECT_EQ(read.lost, std::vector<std::size_t>{3 * kMaxInstruction + 7}) << piece;
  }
}

TEST(MarkerFraming, WhatAReaderHoldsIsBounded) {
  MarkerReader reader(Sender::kClient);
  const Bytes flood(1000, 'x');
  reader.feed(bytes_of("@@"));
  for (int i = 0; i < 1000; ++i) {
    reader.feed(flood);
    while (reader.next(Phase::kTransmission)) {}
    ASSERT_LE(reader.held(), kMaxInstruction + 2 * flood.size());
  }
}

TEST(MarkerFraming, NoiseBetweenFramesIsCountedAndSkipped) {
  const Read read = read_all(bytes_of("\xFFnoise@@HBFEFF..@@abc\rFEFFx"));
  EXPECT_EQ(read.codes, std::vector<std::string>{"HB"});
  EXPECT_EQ(as_text(read.program), "abc\r");
  EXPECT_EQ(read.lost, (std::vector<std::size_t>{6, 2, 1}));
}

TEST(MarkerFraming, ACodeOutsideTheTableIsNotTaken) {
  MarkerReader reader(Sender::kClient);
  Read read;
  read.feed(reader, bytes_of("@@XYFEFF"), Phase::kTransmission);
  EXPECT_TRUE(read.codes.empty() && read.program.empty());
  EXPECT_TRUE(reader.partial());
  const auto half = reader.give_up();
  ASSERT_TRUE(half);
  EXPECT_EQ(half->fault, FrameFault::kHalf);
  EXPECT_EQ(half->bytes, 8u);
  EXPECT_FALSE(reader.partial());
  EXPECT_FALSE(reader.give_up());
}

TEST(MarkerFraming, InTheHandshakeEveryFrameEndsAtTheFirstMarker) {
  const Read read =
      read_all(bytes_of("@@17FEFF@@V2press1FEFF@@@00RD*\rFEFF"), Phase::kHandshake, 1);
  EXPECT_EQ(read.codes, (std::vector<std::string>{"17", "V2press1", "@00RD*\r"}));
  Bytes endless = bytes_of("@@");
  endless.insert(endless.end(), 2 * kMaxHandshakeCode, 'x');
  const Read broken = read_all(endless, Phase::kHandshake);
  ASSERT_FALSE(broken.faults.empty());
  EXPECT_EQ(broken.faults[0], FrameFault::kTooLong);
}

TEST(MarkerFraming, WhatFollowsAFrameCanBeTakenOver) {
  MarkerReader reader(Sender::kBridge);
  reader.feed(bytes_of("@@0000FEFF\x01\x02"));
  ASSERT_TRUE(reader.next(Phase::kHandshake));
  EXPECT_EQ(reader.take_rest(), (Bytes{1, 2}));
  EXPECT_FALSE(reader.partial());
}

// Dialogues of programming software, in one piece and in a module's packets of 64.
TEST(MarkerFraming, TrafficOfProgrammingSoftwareArrivesAsItWas) {
  int carried = 0;
  for (const auto& vector : test::load_vectors("tunnel")) {
    if (vector.name == "all_byte_values") continue;  // no instructions: framing by length
    for (const Bytes& side : {vector.request, vector.response}) {
      if (side.empty()) continue;
      MarkerWriter writer(Sender::kClient);
      Bytes stream;
      for (std::size_t at = 0; at < side.size(); at += 64) {
        EXPECT_TRUE(
            writer
                .write(ByteView(side).subspan(at, std::min<std::size_t>(64, side.size() - at)),
                       stream)
                .empty());
      }
      EXPECT_FALSE(writer.partial()) << vector.name;
      EXPECT_EQ(read_all(stream, Phase::kTransmission, 64).program, side) << vector.name;
      ++carried;
    }
  }
  EXPECT_GE(carried, 8);
}

TEST(MarkerFraming, AReaderThatSkipsGivesUpTheWholeInstruction) {
  MarkerReader reader(Sender::kClient);
  Read read;
  Bytes stream = bytes_of("@@");
  stream.insert(stream.end(), 2 * kMaxInstruction, 'x');
  read.feed(reader, stream, Phase::kTransmission);
  EXPECT_TRUE(read.faults.empty());
  EXPECT_TRUE(reader.partial());
  EXPECT_FALSE(reader.take_code());
  const auto half = reader.give_up();
  ASSERT_TRUE(half);
  EXPECT_EQ(half->fault, FrameFault::kHalf);
  EXPECT_EQ(half->bytes, stream.size());
  read.feed(reader, bytes_of("@@next\rFEFF"), Phase::kTransmission);
  EXPECT_EQ(as_text(read.program), "next\r");
}

TEST(MarkerFraming, AWriterDropsAnInstructionThatIsTooLongInPieces) {
  MarkerWriter writer(Sender::kBridge);
  EXPECT_FALSE(writer.partial());
  EXPECT_FALSE(writer.give_up());
  Bytes out;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(writer.write(Bytes(kMaxInstruction, 'x'), out).empty());
  EXPECT_TRUE(writer.partial());
  const auto lost = writer.write(bytes_of("\rnext\r"), out);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].fault, FrameFault::kTooLong);
  EXPECT_EQ(lost[0].bytes, 3 * kMaxInstruction + 1);
  EXPECT_EQ(as_text(out), "@@next\rFEFF");
  EXPECT_FALSE(writer.partial());
  ASSERT_TRUE(writer.write(Bytes(kMaxInstruction + 1, 'x'), out).empty());
  const auto half = writer.give_up();
  ASSERT_TRUE(half);
  EXPECT_EQ(half->fault, FrameFault::kHalf);
  EXPECT_EQ(half->bytes, kMaxInstruction + 1);
}

}  // namespace
}  // namespace fieldcast::program

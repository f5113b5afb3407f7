#include "core/capture/pcapng.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "core/capture/pcapng_reader.hpp"
#include "core/capture/trace_text.hpp"

namespace fieldcast::pcapng {
namespace {

// Tests the reader with the writer and with invalid files; e2e_capture.py uses Wireshark.

Reader::Source source_of(ByteView bytes) {
  return [bytes](std::uint8_t* to, std::size_t size) mutable {
    const std::size_t given = std::min(size, bytes.size());
    std::memcpy(to, bytes.data(), given);
    bytes = bytes.subspan(given);
    return given;
  };
}

Bytes file_of_two() {
  Bytes file;
  append_section(file, "Fieldcast", "bus line");
  append_interface(file, "line", "of a test");
  append_packet(file, {{1'700'000'000'123'456'000}, Direction::kSent, Bytes{1, 2, 3}, "read °C"});
  append_packet(file, {{1'700'000'000'223'456'000}, Direction::kReceived, Bytes{4, 5, 6, 7}, ""});
  append_statistics(file, {.frames = 2, .dropped = 7});
  return file;
}

TEST(Pcapng, WhatIsWrittenIsReadAgain) {
  const Bytes file = file_of_two();
  Reader reader(source_of(file));
  auto first = reader.next();
  ASSERT_TRUE(first && *first);
  EXPECT_EQ((*first)->interface.name, "line");
  EXPECT_EQ((*first)->interface.linktype, 252);
  EXPECT_EQ((*first)->at.nanoseconds, 1'700'000'000'123'456'000);
  EXPECT_EQ((*first)->direction, Direction::kSent);
  EXPECT_EQ((*first)->comment, "read °C");
  EXPECT_EQ((*first)->data, (Bytes{1, 2, 3}));
  auto second = reader.next();
  ASSERT_TRUE(second && *second);
  EXPECT_EQ((*second)->direction, Direction::kReceived);
  EXPECT_EQ((*second)->comment, "");
  EXPECT_EQ((*second)->data, (Bytes{4, 5, 6, 7}));
  auto end = reader.next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(*end);
  EXPECT_EQ(reader.dropped(), 7u);
}

TEST(Pcapng, AFileCutAnywhereGivesWhatIsWhole) {
  const Bytes file = file_of_two();
  for (std::size_t size = 0; size < file.size(); ++size) {
    Reader reader(source_of(ByteView(file).first(size)));
    std::size_t packets = 0;
    auto read = reader.next();
    for (; read && *read; read = reader.next()) ++packets;
    if (read) continue;  // between two blocks
    EXPECT_TRUE(read.error() == Fault::kCut || (packets == 0 && read.error() == Fault::kNoCapture))
        << size << ": " << to_text(read.error());
  }
}

TEST(Pcapng, NoByteCanMakeItReadBeyondAnEnd) {
  const Bytes good = file_of_two();
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const int value : {0x00, 0x7F, 0x80, 0xFF}) {
      Bytes file = good;
      file[at] = static_cast<std::uint8_t>(value);
      Reader reader(source_of(file));
      for (int i = 0; i < 10; ++i) {
        const auto read = reader.next();
        if (!read || !*read) break;
      }
    }
  }
}

// A section of another machine: big-endian, nanoseconds, an unknown block and an unknown option.
TEST(Pcapng, TheOtherByteOrderIsRead) {
  const auto file = from_hex(
      "0A0D0D0A 0000001C 1A2B3C4D 00010000 FFFFFFFF FFFFFFFF 0000001C"
      "00000001 00000020 00FC0000 00000000 00090001 09000000 00000000 00000020"
      "0000BEEF 00000010 01020304 00000010"
      "00000006 0000002C 00000000 17979CFE 362A0000 00000002 00000003 AABB0000"
      "00020004 00000001 0000002C");
  ASSERT_TRUE(file);
  Reader reader(source_of(*file));
  const auto read = reader.next();
  ASSERT_TRUE(read && *read) << (read ? "end" : to_text(read.error()));
  EXPECT_EQ((*read)->data, (Bytes{0xAA, 0xBB}));
  EXPECT_TRUE((*read)->cut);
  EXPECT_EQ((*read)->at.nanoseconds, 0x17979CFE362A0000);
  EXPECT_EQ((*read)->direction, Direction::kReceived);
}

TEST(Pcapng, WhatIsNotACaptureIsNamed) {
  const auto fault_of = [](const Bytes& bytes) { return Reader(source_of(bytes)).next().error(); };
  EXPECT_EQ(fault_of({}), Fault::kNoCapture);
  EXPECT_EQ(fault_of(Bytes(100, 'x')), Fault::kNoCapture);
  EXPECT_EQ(fault_of(*from_hex("D4C3B2A1 02000400 00000000")), Fault::kOldFormat);
  EXPECT_EQ(fault_of(*from_hex("A1B23C4D 00020004 00000000")), Fault::kOldFormat);
  EXPECT_EQ(fault_of(*from_hex("0A0D0D0A 00000020 4D3C2B1A 01000000")), Fault::kTooLong);
}

TEST(UpperPdu, ItsTagsNameTheDissectorAndTheDirection) {
  const Bytes frame{1, 3, 0, 0};
  const Bytes bytes = make_upper_pdu("mbrtu", "", Direction::kSent, frame);
  EXPECT_EQ(to_hex(bytes),
            "00 0C 00 08 6D 62 72 74 75 00 00 00 00 18 00 04 00 00 00 02 00 19 00 04 00 00 C0 00 "
            "00 1A 00 04 00 00 01 F6 00 00 00 00 01 03 00 00");
  const auto parsed = parse_upper_pdu(bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->dissector, "mbrtu");
  EXPECT_EQ(parsed->destination_port, kDevicePort);
  EXPECT_EQ(Bytes(parsed->frame.begin(), parsed->frame.end()), frame);
}

TEST(UpperPdu, TagsThatDoNotEndAreNone) {
  const Bytes bytes = make_upper_pdu("fieldcast-frame", "mine", Direction::kReceived, {});
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(parse_upper_pdu(ByteView(bytes).first(size))) << size;
  EXPECT_EQ(parse_upper_pdu(bytes)->column, "mine");
}

}  // namespace
}  // namespace fieldcast::pcapng

namespace fieldcast {
namespace {

using Mark = TraceText::Mark;

TEST(TraceText, ALineAsTheBridgePrintsIt) {
  const auto sent =
      parse_trace_text("2026-11-22T14:24:21.126358Z press-shop >> 01 03 00 64 00 02 85 D4");
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent->time, "2026-11-22T14:24:21.126358Z");
  EXPECT_EQ(sent->bus, "press-shop");
  EXPECT_EQ(sent->mark, Mark::kSent);
  EXPECT_EQ(to_hex(sent->bytes), "01 03 00 64 00 02 85 D4");
}

TEST(TraceText, AJournalPutsMoreBeforeIt) {
  const auto received = parse_trace_text(
      "Nov 22 14:24:21 gate fieldcast-bridge[812]: 2026-11-22T14:24:21.126358Z line << 01 83 02\r");
  ASSERT_TRUE(received);
  EXPECT_EQ(received->bus, "line");
  EXPECT_EQ(received->mark, Mark::kReceived);
  EXPECT_EQ(to_hex(received->bytes), "01 83 02");
}

TEST(TraceText, ARemarkNeedsItsTime) {
  const auto remark = parse_trace_text("2026-11-22T14:24:21.126358Z line -- meter: no response");
  ASSERT_TRUE(remark);
  EXPECT_EQ(remark->mark, Mark::kRemark);
  EXPECT_EQ(remark->text, "meter: no response");
  EXPECT_FALSE(parse_trace_text("see the manual -- page 7"));
}

TEST(TraceText, APieceOfALineWillDo) {
  const auto piece = parse_trace_text("  line >> 0103");
  ASSERT_TRUE(piece);
  EXPECT_EQ(piece->bus, "line");
  EXPECT_TRUE(piece->time.empty());
  EXPECT_EQ(parse_trace_text(">> 01 03")->bus, "");
  EXPECT_EQ(parse_trace_text("2026-11-22T14:24:21.1Z >> 01")->bus, "");
}

// Each word lacks one part of a time, so that it is the name of the bus.
TEST(TraceText, ANameLikeATimeIsAName) {
  for (const char* word : {"2026-11-22T14:24:21Z", "2026-11-22T14:24:21.1Z"})
    EXPECT_EQ(parse_trace_text(std::string(word) + " >> 01")->time, word);
  for (const char* word :
       {"2026-11-22T14:24:1Z", "2026:11-22T14:24:21.1Z", "2026-11-22-14:24:21.1Z",
        "2026-11-22T14:24:21.12", "2026-11-22T14:24:21.1aZ"})
    EXPECT_EQ(parse_trace_text(std::string(word) + " >> 01")->bus, word);
}

TEST(TraceText, WhatIsNotATraceIsNone) {
  for (const char* text :
       {"", "hello", "line >>", "line >> xyz", "a>>b", "line >> 01 0", "line >>01", "line>> 01"})
    EXPECT_FALSE(parse_trace_text(text)) << text;
}

TEST(UpperPdu, WhatIsWrittenIsReadAgain) {
  const Bytes frame{1, 3, 0, 100};
  for (const std::string_view column : {"", "Modbus/RTU"}) {
    const Bytes sent = make_upper_pdu("mbrtu", column, Direction::kSent, frame);
    EXPECT_EQ(sent.size() % 4, 0u);
    const auto pdu = parse_upper_pdu(sent);
    ASSERT_TRUE(pdu);
    EXPECT_EQ(pdu->dissector, "mbrtu");
    EXPECT_EQ(pdu->column, column);
    EXPECT_EQ(pdu->source_port, kMasterPort);
    EXPECT_EQ(pdu->destination_port, kDevicePort);
    EXPECT_TRUE(std::equal(pdu->frame.begin(), pdu->frame.end(), frame.begin(), frame.end()));
  }
  const Bytes received = make_upper_pdu("mbrtu", "", Direction::kReceived, frame);
  EXPECT_EQ(parse_upper_pdu(received)->source_port, kDevicePort);
  EXPECT_EQ(parse_upper_pdu(received)->destination_port, kMasterPort);
}

TEST(UpperPdu, TagsWithoutAnEndAreRefused) {
  const Bytes sent = make_upper_pdu("mbrtu", "", Direction::kSent, {});
  for (std::size_t size = 0; size < sent.size(); ++size)
    EXPECT_FALSE(parse_upper_pdu(ByteView(sent).first(size))) << size;
  const Bytes odd = *from_hex("00 19 00 03 00 00 01 00 00 00 00");
  ASSERT_TRUE(parse_upper_pdu(odd));
  EXPECT_EQ(parse_upper_pdu(odd)->source_port, std::nullopt) << "a port has four bytes";
  EXPECT_EQ(parse_upper_pdu(*from_hex("00 1A 00 03 00 00 01 00 00 00 00"))->destination_port,
            std::nullopt);
}

}  // namespace
}  // namespace fieldcast

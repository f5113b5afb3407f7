#include "core/capture/trace_text.hpp"

#include <gtest/gtest.h>

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

TEST(TraceText, WhatIsNoTraceIsNone) {
  for (const char* text : {"", "hello", "line >>", "line >> xyz", "a>>b", "line >> 01 0"})
    EXPECT_FALSE(parse_trace_text(text)) << text;
}

}  // namespace
}  // namespace fieldcast

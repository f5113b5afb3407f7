// The size of the first frame of a stream, for protocols with several requests in flight.
#include <gtest/gtest.h>

#include <set>

#include "core/protocol/families/registry.hpp"

namespace fieldcast::test {
namespace {

struct Stream {
  std::string_view protocol, frame, not_a_frame;
};

const Stream kStreams[] = {
    {"modbus-tcp", "00 01 00 00 00 06 11 03 00 6B 00 03", "00 01 00 01 00 06 11 03 00 6B 00 03"},
    {"s7-tcp", "03 00 00 1B 02 F0 80 32 03 00 00 00 01 00 02 00 06 00 00 04 01 FF 04 00 10 12 34",
     "04 00 00 1B 02 F0 80 32"},
    {"omron-fins",
     "46 49 4E 53 00 00 00 18 00 00 00 02 00 00 00 00 C0 00 02 00 EF 00 00 0A 00 01 01 01 00 00 12 "
     "34",
     "46 49 4E 54 00 00 00 18 00 00 00 02 00 00 00 00"},
    {"mitsubishi-mc", "D4 00 34 12 00 00 00 FF FF 03 00 08 00 00 00 34 12 02 00 EF 1D",
     "D7 00 34 12 00 00 00 FF FF 03 00 08 00 00 00"},
    {"mitsubishi-mc",  // D4001234000000FF03FF00000C0000 12340002, in ASCII
     "44 34 30 30 31 32 33 34 30 30 30 30 30 30 46 46 30 33 46 46 30 30 30 30 30 43 30 30 30 30 31 "
     "32 33 34 30 30 30 32",
     "44 39 30 30 31 32 33 34 30 30 30 30 30 30 46 46 30 33 46 46 30 30 30 30 30 43"}};

TEST(FirstFrame, IsWholeOrOpenOrNone) {
  std::set<std::string_view> tested;
  for (const Stream& row : kStreams) {
    const auto first_frame = find_protocol(row.protocol)->first_frame;
    ASSERT_NE(first_frame, nullptr) << row.protocol;
    tested.insert(row.protocol);
    Bytes stream = *from_hex(row.frame);
    const std::size_t size = stream.size();
    for (std::size_t part = 0; part < size; ++part)
      EXPECT_EQ(first_frame(ByteView(stream).first(part)), 0u) << row.protocol << ' ' << part;
    EXPECT_EQ(first_frame(stream), size) << row.protocol;
    append(stream, *from_hex(row.frame));
    EXPECT_EQ(first_frame(stream), size) << row.protocol << ", two frames";
    EXPECT_EQ(first_frame(*from_hex(row.not_a_frame)), std::nullopt) << row.protocol;
  }
  for (const ProtocolEntry& entry : protocols())
    EXPECT_EQ(entry.first_frame != nullptr, tested.contains(entry.name)) << entry.name;
}

}  // namespace
}  // namespace fieldcast::test

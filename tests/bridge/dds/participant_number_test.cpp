#include <gtest/gtest.h>

#include <random>

#include "bridge/dds/transport/guard_transport.hpp"

namespace fieldcast {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Data from participant 01 0f 01 02 .. 0a to a discovery server: INFO_TS, and DATA with the
// parameter 800f, which says that `author` wrote it with the number `upper` * 2^32 + 7.
Bytes announced(std::uint8_t author, std::uint8_t upper, std::uint8_t entity = 0xc2) {
  return {
      'R',   'T',  'P', 'S',  2,    2, 1, 15,     1, 15, 1, 2,      3, 4, 5, 6,
      7,     8,    9,   10,   0x09, 1, 8, 0,      5, 0,  0, 0,      0, 0, 0, 0,       // 20
      0x15,  7,    56,  0,                                                            // 32
      0,     0,    16,  0,                                                            //
      0,     1,    0,   0xc7, 0,    1, 0, entity,                                     // to, from
      0,     0,    0,   0,    7,    0, 0, 0,                                          //
      0x0f,  0x80, 24,  0,                                                            // 56
      1,     15,   1,   2,    3,    4, 5, 6,      7, 8,  9, author, 0, 1, 0, entity,  //
      upper, 0,    0,   0,    7,    0, 0, 0,                                          // 76
      1,     0,    0,   0,                                                            //
      0,     3,    0,   0                                                             // the message
  };
}

TEST(ParticipantNumber, AnAnnouncementGetsANumberAboveAllOfAServer) {
  EXPECT_EQ(with_number_above_servers(announced(10, 0)), announced(10, 1));
}

// INFO_TS without a time has length 0, which does not extend to the end of the message.
TEST(ParticipantNumber, AnAnnouncementIsFoundBehindAnEmptySubmessage) {
  const auto without_instant = [](Bytes bytes) {
    bytes[21] |= 2;
    bytes[22] = 0;
    bytes.erase(bytes.begin() + 24, bytes.begin() + 32);
    return bytes;
  };
  EXPECT_EQ(with_number_above_servers(without_instant(announced(10, 0))),
            without_instant(announced(10, 1)));
}

TEST(ParticipantNumber, ItIsTheSameEachTime) {
  EXPECT_EQ(with_number_above_servers(announced(10, 1)), announced(10, 1));
}

TEST(ParticipantNumber, WhatOthersWroteIsSentAsItIs) {
  EXPECT_TRUE(with_number_above_servers(announced(11, 0)).empty());
}

TEST(ParticipantNumber, WhatIsSaidOfEndpointsIsSentAsItIs) {
  EXPECT_TRUE(with_number_above_servers(announced(10, 0, 0x03)).empty());
}

// Also runs under the sanitizers, which detect reads beyond the end of a message.
TEST(ParticipantNumber, AnyBytesAreReadWithinTheMessage) {
  std::mt19937 random(1);
  int changed = 0;
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = announced(10, 0);
    for (unsigned n = random() % 4; n > 0; --n)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
    if (random() % 2 == 0) bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();
    const Bytes other = with_number_above_servers(bytes);
    changed += !other.empty();
    EXPECT_TRUE(other.empty() || other.size() == bytes.size());
  }
  EXPECT_GT(changed, 0);
}

}  // namespace
}  // namespace fieldcast

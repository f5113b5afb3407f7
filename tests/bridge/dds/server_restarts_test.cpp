#include "bridge/dds/transport/server_restarts.hpp"

#include <gtest/gtest.h>

#include <random>

namespace fieldcast {
namespace {

using Bytes = ServerRestarts::Bytes;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Instant kStart{seconds{100}};

// Returns a message of the discovery server with identity 1; RTPS 2.2, 9.4.
Bytes from_server(std::initializer_list<std::uint8_t> submessages) {
  Bytes bytes{'R', 'T', 'P', 'S', 2,   2,   1,   15,  'D', 'S',
              1,   '_', 'E', 'P', 'R', 'O', 'S', 'I', 'M', 'A'};
  bytes.insert(bytes.end(), submessages);
  return bytes;
}
// 09 flags length | seconds, fraction; 15 flags length | extra to-inline-qos reader writer number
Bytes announcement(std::uint8_t number, std::uint8_t second) {
  return from_server({0x09, 1, 8,  0,    second, 0, 0,  0,    0, 0, 0, 0,  //
                      0x15, 5, 20, 0,    0,      0, 16, 0,                 //
                      0,    1, 0,  0xc7, 0,      1, 0,  0xc2,              //
                      0,    0, 0,  0,    number, 0, 0,  0});
}
// 07 flags length | reader writer first last count
Bytes heartbeat(std::uint8_t last, std::uint8_t count) {
  return from_server({0x07, 3, 28, 0, 0,    1, 0, 0xc7, 0,     1, 0, 0xc2,  //
                      0,    0, 0,  0, 1,    0, 0, 0,                        //
                      0,    0, 0,  0, last, 0, 0, 0,    count, 0, 0, 0});
}

// Of our writers, or of our readers: 06 flags length | reader writer base bits count
Bytes acknowledgement(std::uint8_t base, std::uint8_t count, std::uint8_t entity = 3) {
  return from_server({0x06, 1, 24, 0, 0,     0, entity, 0xc7, 0, 0, entity, 0xc2,  //
                      0,    0, 0,  0, base,  0, 0,      0,                         //
                      0,    0, 0,  0, count, 0, 0,      0});
}
Bytes from_other(std::uint8_t number) {
  Bytes bytes = heartbeat(1, 1);
  for (std::size_t i = 8; i < 20; ++i) bytes[i] = number;
  return bytes;
}
ParticipantPrefix other(std::uint8_t number) {
  ParticipantPrefix prefix;
  prefix.fill(number);
  return prefix;
}

struct Restarts : ::testing::Test {
  Restarts() { restarts.on_server(1, true); }
  bool says_goodbye(const Bytes& message, Instant now = kStart) {
    return !restarts.goodbye_before(message, now).empty();
  }
  void hear_all() {
    EXPECT_FALSE(says_goodbye(acknowledgement(0, 4)));
    EXPECT_FALSE(says_goodbye(acknowledgement(2, 5), kStart + seconds{1}));
    for (const std::uint8_t number : std::initializer_list<std::uint8_t>{1, 2}) {
      restarts.on_other(other(number), true);
      EXPECT_FALSE(says_goodbye(from_other(number), kStart + seconds{2}));
    }
  }
  // Returns the participants whose end is reported before this message, the server last.
  std::vector<int> ends_before(const Bytes& message, Instant now) {
    const Bytes goodbye = restarts.goodbye_before(message, now);
    std::vector<int> ends;
    constexpr std::size_t kEnd = 56, kKey = 28;  // bytes of DATA, and before its key
    for (std::size_t at = 20 + 32; at < goodbye.size(); at += kEnd)
      ends.push_back(goodbye[at + kKey]);
    return ends;
  }
  ServerRestarts restarts;
};

TEST_F(Restarts, AMemberThatWasGivenUpForgetsSilentMembers) {
  hear_all();
  EXPECT_EQ(ends_before(acknowledgement(0, 6), kStart + seconds{14}),
            (std::vector<int>{1, 2, 'D'}));
}

TEST_F(Restarts, WhoWasGivenUpKeepsThoseThatWereHeard) {
  hear_all();
  for (int second = 4; second < 14; second += 2)
    EXPECT_FALSE(says_goodbye(from_other(2), kStart + seconds{second}));
  EXPECT_EQ(ends_before(acknowledgement(0, 6), kStart + seconds{14}), (std::vector<int>{1, 'D'}));
}

TEST_F(Restarts, WhoIsHeardAgainAMomentBeforeWasSilent) {
  hear_all();
  EXPECT_FALSE(says_goodbye(from_other(2), kStart + milliseconds{13'900}));
  EXPECT_EQ(ends_before(acknowledgement(0, 6), kStart + seconds{14}),
            (std::vector<int>{1, 2, 'D'}));
}

TEST_F(Restarts, WhoWasAnnouncedAMomentBeforeIsKept) {
  hear_all();
  EXPECT_FALSE(says_goodbye(from_other(2), kStart + milliseconds{13'900}));
  restarts.on_other(other(2), true);
  EXPECT_EQ(ends_before(acknowledgement(0, 6), kStart + seconds{14}), (std::vector<int>{1, 'D'}));
}

TEST_F(Restarts, WhatIsReportedOfOthersBeforeTheServerIsFoundAgainIsReportedThen) {
  hear_all();
  EXPECT_EQ(ends_before(heartbeat(9, 9), kStart + seconds{14}), std::vector<int>{'D'});
  EXPECT_TRUE(ends_before(acknowledgement(0, 6), kStart + milliseconds{14'100}).empty());
  restarts.on_server(1, true);
  EXPECT_EQ(ends_before(acknowledgement(0, 7), kStart + milliseconds{14'200}),
            (std::vector<int>{1, 2, 'D'}));
}

TEST_F(Restarts, AMemberNeitherHeardNorAnnouncedSinceAServerRestartedIsForgotten) {
  hear_all();
  EXPECT_FALSE(says_goodbye(announcement(7, 20), kStart + seconds{3}));
  EXPECT_TRUE(says_goodbye(announcement(1, 30), kStart + seconds{4})) << "another server";
  restarts.on_server(1, true);
  EXPECT_FALSE(says_goodbye(announcement(2, 31), kStart + seconds{5}));
  restarts.on_other(other(2), true);  // announced
  for (int second = 8; second < 24; second += 2)
    EXPECT_FALSE(says_goodbye(announcement(2, 31), kStart + seconds{second}));
  EXPECT_EQ(ends_before(announcement(2, 31), kStart + seconds{24}), (std::vector<int>{1, 'D'}));
  restarts.on_other(other(1), false);
  restarts.on_server(1, true);
  EXPECT_FALSE(says_goodbye(announcement(2, 31), kStart + seconds{26})) << "once";
}

TEST_F(Restarts, WhoIsHeardWithoutAServerIsKept) {
  hear_all();
  EXPECT_FALSE(says_goodbye(announcement(7, 20), kStart + seconds{3}));
  EXPECT_TRUE(says_goodbye(announcement(1, 30), kStart + seconds{4})) << "another server";
  restarts.on_server(1, true);
  for (int second = 6; second < 80; second += 2) {
    for (const std::uint8_t number : std::initializer_list<std::uint8_t>{1, 2})
      EXPECT_FALSE(says_goodbye(from_other(number), kStart + seconds{second}));
    EXPECT_FALSE(says_goodbye(announcement(2, 31), kStart + seconds{second}));
  }
}

TEST_F(Restarts, AnAcknowledgementThatComesLateIsNotANewBeginning) {
  hear_all();
  EXPECT_FALSE(says_goodbye(acknowledgement(0, 4), kStart + seconds{3}));
  EXPECT_FALSE(says_goodbye(acknowledgement(0, 4, 4), kStart + seconds{3})) << "of our readers";
}

TEST_F(Restarts, ANewBeginningIsTakenForOne) {
  hear_all();
  EXPECT_TRUE(says_goodbye(acknowledgement(0, 6), kStart + seconds{14}));
  restarts.on_server(1, true);
  EXPECT_FALSE(says_goodbye(acknowledgement(0, 7), kStart + milliseconds{14'070}));
  EXPECT_FALSE(says_goodbye(acknowledgement(2, 8), kStart + milliseconds{14'500}));
}

TEST_F(Restarts, ANumberThatReturnsWithALaterInstantIsAnotherServers) {
  EXPECT_FALSE(says_goodbye(announcement(7, 20)));
  EXPECT_FALSE(says_goodbye(announcement(9, 30)));
  EXPECT_TRUE(says_goodbye(announcement(1, 40)));
}

TEST_F(Restarts, WhatIsSentAgainOrComesLateIsOfTheSameServer) {
  EXPECT_FALSE(says_goodbye(announcement(9, 30)));
  EXPECT_FALSE(says_goodbye(announcement(7, 20)));
  EXPECT_FALSE(says_goodbye(announcement(9, 30)));
  EXPECT_FALSE(says_goodbye(announcement(10, 30)));
}

TEST_F(Restarts, AServerThatWasNotHeardForLongerThanItWaitsForUsIsJoinedAgain) {
  EXPECT_FALSE(says_goodbye(announcement(9, 30), kStart));
  EXPECT_FALSE(says_goodbye(heartbeat(9, 4), kStart + seconds{6}));
  EXPECT_TRUE(says_goodbye(heartbeat(9, 5), kStart + seconds{18}));
  EXPECT_FALSE(says_goodbye(heartbeat(9, 6), kStart + seconds{19})) << "once";
  restarts.on_server(1, true);
  EXPECT_FALSE(says_goodbye(announcement(10, 50), kStart + seconds{20}));
}

TEST_F(Restarts, HeartbeatsThatRestartAreAnotherServers) {
  EXPECT_FALSE(says_goodbye(heartbeat(50, 80), kStart));
  EXPECT_FALSE(says_goodbye(heartbeat(50, 81), kStart + seconds{2}));
  EXPECT_FALSE(says_goodbye(heartbeat(49, 82), kStart + seconds{3})) << "the last one was let go";
  EXPECT_TRUE(says_goodbye(heartbeat(3, 2), kStart + seconds{5}));
}

TEST_F(Restarts, HeartbeatsThatOvertakeEachOtherAreOfTheSameServer) {
  EXPECT_FALSE(says_goodbye(heartbeat(50, 80), kStart));
  EXPECT_FALSE(says_goodbye(heartbeat(49, 79), kStart + milliseconds{30}));
  EXPECT_FALSE(says_goodbye(heartbeat(51, 82), kStart + seconds{6}));
  EXPECT_FALSE(says_goodbye(heartbeat(50, 81), kStart + seconds{6} + milliseconds{30}));
}

TEST_F(Restarts, AServerThatTheLibraryDoesNotKnowIsNotTakenLeaveOf) {
  restarts.on_server(1, false);
  EXPECT_FALSE(says_goodbye(announcement(9, 30)));
  EXPECT_FALSE(says_goodbye(announcement(1, 40)));
  restarts.on_server(1, true);
  EXPECT_FALSE(says_goodbye(announcement(2, 41))) << "it is the one that is known now";
}

TEST_F(Restarts, LeaveIsTakenOnceUntilTheServerIsFound) {
  EXPECT_FALSE(says_goodbye(announcement(9, 30)));
  EXPECT_TRUE(says_goodbye(announcement(1, 40)));
  EXPECT_FALSE(says_goodbye(announcement(1, 50)));
  restarts.on_server(1, true);
  EXPECT_TRUE(says_goodbye(announcement(1, 60)));
}

TEST_F(Restarts, OthersMayRestartAsTheyLike) {
  Bytes before = announcement(9, 30), after = announcement(1, 40);
  before[8] = after[8] = 'X';
  EXPECT_FALSE(says_goodbye(before));
  EXPECT_FALSE(says_goodbye(after));
  EXPECT_FALSE(says_goodbye({}));
}

TEST_F(Restarts, TheGoodbyeIsThatOfAServerThatEnds) {
  EXPECT_FALSE(says_goodbye(announcement(9, 30)));
  const Bytes expected = from_server({
      0x07, 3,    28,   0,                        // heartbeat, no response requested
      0,    1,    0,    0xc7, 0,   1,   0, 0xc2,  // of participants
      0,    0,    0,    0,    10,  0,   0, 0,     // first available number
      0,    0,    0,    0,    10,  0,   0, 0,     // last number
      0xff, 0xff, 0xff, 0x7f,                     // count
      0x15, 3,    52,   0,                        // data with inline QoS
      0,    0,    16,   0,                        //
      0,    1,    0,    0xc7, 0,   1,   0, 0xc2,  //
      0,    0,    0,    0,    10,  0,   0, 0,     // the number
      0x70, 0,    16,   0,    'D', 'S', 1, '_',  'E', 'P', 'R', 'O',  // the key
      'S',  'I',  'M',  'A',  0,   0,   1, 0xc1,                      //
      0x71, 0,    4,    0,    0,   0,   0, 3,                         // disposed and unregistered
      1,    0,    0,    0,                                            // the end
  });
  EXPECT_EQ(restarts.goodbye_before(announcement(1, 40), kStart), expected);
}

// Also runs under the sanitizers, which detect reads beyond the end of a message.
TEST_F(Restarts, AnyBytesAreReadWithinTheMessage) {
  std::mt19937 random(1);
  Bytes all = announcement(9, 30);
  for (const Bytes& more : {heartbeat(50, 80), acknowledgement(2, 5)})
    all.insert(all.end(), more.begin() + 20, more.end());
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = all;
    for (unsigned n = random() % 4; n > 0; --n)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();
    (void)restarts.goodbye_before(bytes, kStart + milliseconds{i});
    restarts.on_server(1, true);
  }
}

}  // namespace
}  // namespace fieldcast

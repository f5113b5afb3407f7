// Later terms that a master takes because a member may have been master out of its sight, and
// readers may have followed that one.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/bridge/standby/election_group.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using election_group::Group;
using Members = std::vector<std::string>;

// Whoever is out of sight may have been master for the readers that come now.
TEST(Election, AMasterTakesALaterTermForReadersWhileAMemberIsOutOfSight) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  const auto readers_come = [&] { group.of(a).readers_came(group.clock(group.node(a))); };
  const auto first = group.of(a).term();
  readers_come();
  group.run(Election::kReturn + 1s);
  EXPECT_EQ(group.of(a).term(), first) << "who is heard says itself what it knows";

  group.part(a, b);
  group.run(2s);
  ASSERT_EQ(group.masters(), (Members{"a", "b"}));
  const auto others = number_of(group.of(b).term());
  ASSERT_GT(others, number_of(first));
  group.kill(b);
  readers_come();
  group.run(Election::kReturn - 100ms);
  EXPECT_EQ(group.of(a).term(), first) << "it may be heard again";
  group.run(200ms);
  const auto later = group.of(a).term();
  EXPECT_GT(number_of(later), others);
  EXPECT_EQ(group.masters(), Members{"a"});

  readers_come();
  group.run(Election::kReturn + 1s);
  EXPECT_EQ(group.of(a).term(), later) << "not for each reader";
  group.run(Election::kForReaders);
  EXPECT_GT(number_of(group.of(a).term()), number_of(later));
}

// It takes terms for its readers, too.
TEST(Election, ATermForReadersIsAboveThoseThatAMemberOutOfSightTook) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  group.part(a, b);
  for (int readers = 0; readers < 5; ++readers) {
    group.run(Election::kForReaders);
    group.of(b).readers_came(group.clock(group.node(b)));
  }
  group.run(Election::kForReaders);
  const auto others = number_of(group.of(b).term());
  ASSERT_GT(others, number_of(group.of(a).term()) + Election::kUnheardTerms);
  group.kill(b);
  group.of(a).readers_came(group.clock(group.node(a)));
  group.run(Election::kReturn + 1s);
  EXPECT_GT(number_of(group.of(a).term()), others);
}

TEST(Election, AMasterThatStoodStillListensBeforeItTakesALaterTerm) {
  Instant now{1h};
  StandbyMember own, other;
  own.bridge = "a";
  Election a(own, now);
  a.set_not_ready("");
  const auto pass = [&](Duration time) {
    for (const Instant end = now + time; now < end; now += Election::kTick) a.on_time(now);
  };
  other.bridge = "b";
  other.since = other.beat = 1;
  other.not_ready = "it has just begun";
  a.receive(other, now);
  pass(3s);
  ASSERT_TRUE(a.serves(now));
  const auto first = a.term();
  now += 4s;  // b began anew, and was master perhaps
  other.since = 2;
  a.receive(other, now);
  a.on_time(now);
  EXPECT_FALSE(a.serves(now));
  EXPECT_EQ(a.term(), first);
  pass(Election::kListen + Election::kTick);
  EXPECT_TRUE(a.serves(now));
  EXPECT_GT(a.term(), first);
}

TEST(Election, WhoIsSeenToEndIsNotOutOfSight) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  const auto first = group.of(a).term();
  group.kill(b);
  group.of(a).lost("b", group.clock(group.node(a)));
  group.run(1s);
  group.of(a).readers_came(group.clock(group.node(a)));
  group.run(Election::kReturn + 1s);
  EXPECT_EQ(group.of(a).term(), first);
}

// As when it has joined, followed a block, and the master stood still before it said a word.
TEST(Election, WhoFollowsSamplesOfALaterTermThanItsOwnTakesALaterOne) {
  Group group(1);
  const auto a = group.add("a", 1);
  group.run(2s);
  const auto first = group.of(a).term();
  ASSERT_EQ(number_of(first), 1u);
  group.of(a).follows(0);
  EXPECT_EQ(group.of(a).term(), first) << "nothing was followed";
  group.of(a).follows(sequences_of(StandbyTerm{7} << 32) + 100);
  EXPECT_EQ(number_of(group.of(a).term()), 8u);
  group.of(a).follows(sequences_of(StandbyTerm{7} << 32) + 200);
  EXPECT_EQ(number_of(group.of(a).term()), 8u);
}

}  // namespace
}  // namespace fieldcast

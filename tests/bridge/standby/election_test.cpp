// Tests the election of the master: single rules, and whole groups in virtual time over many seeds,
// with loss, delay, duplicates, partitions, restarts, suspended processes and clocks that differ.
#include "bridge/standby/election.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/bridge/standby/election_group.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using namespace election_group;

using Names = std::vector<std::string>;

TEST(Election, TheStrongestOfThoseThatBeginTogetherIsMaster) {
  Group group(1);
  group.add("a", 1);
  group.add("b", 2);
  group.run(2s);
  EXPECT_EQ(group.masters(), Names{"b"});
  EXPECT_EQ(group.longest_two, 0ms);
}

TEST(Election, OfEquallyStrongTheFirstByNameIsMaster) {
  Group group(1);
  group.add("b", 1);
  group.add("a", 1);
  group.run(2s);
  EXPECT_EQ(group.masters(), Names{"a"});
}

// As if all had waited for one discovery server.
TEST(Election, OfTwoThatBecomeReadyAtOneTimeOneIsMaster) {
  for (const Duration apart : {Duration{0ms}, Duration{4ms}, Duration{40ms}, Duration{140ms}}) {
    Group group(1);
    const auto a = group.add("a", 1);
    const auto b = group.add("b", 1);
    group.of(a).set_not_ready("it waits");
    group.of(b).set_not_ready("it waits");
    group.run(5s);
    group.of(b).set_not_ready("");
    if (apart > 0ms) group.run(apart);
    group.of(a).set_not_ready("");
    group.run(3s);
    EXPECT_EQ(group.masters().size(), 1u);
    EXPECT_EQ(group.longest_two, 0ms) << to_text(apart);
  }
}

TEST(Election, AMasterStaysWhenAnyMemberJoinsLater) {
  Group group(1);
  group.add("weak", 1);
  group.run(2s);
  group.add("strong", 9);
  group.run(5s);
  EXPECT_EQ(group.masters(), Names{"weak"});
}

TEST(Election, ADeadMasterIsReplacedWithinItsLeaseAndATick) {
  Group group(1);
  const auto a = group.add("a", 2);
  group.add("b", 1);
  group.run(2s);
  group.kill(a);
  group.run(Election::kLease + Election::kTick + 3ms);
  EXPECT_EQ(group.masters(), Names{"b"});
}

TEST(Election, AProcessThatIsSeenToEndIsReplacedImmediately) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  group.kill(a);
  group.of(b).lost("a", group.clock(group.node(b)));
  group.run(Election::kTick + 1ms);
  EXPECT_EQ(group.masters(), Names{"b"});
}

TEST(Election, AStrongerOneThatDoesNotTakeOverIsNotWaitedForForEver) {
  Election own(member("b", 1), kStart);
  own.set_not_ready("");
  StandbyMember stronger = member("a", 5);
  Instant now = kStart;
  const auto run = [&](Duration time) {
    for (const Instant end = now + time; now < end; now += Election::kTick) {
      ++stronger.beat;
      own.receive(stronger, now);
      own.on_time(now);
    }
  };
  run(Election::kSettle + Election::kPatience - 100ms);
  EXPECT_EQ(own.role(), StandbyRole::kWaiting);
  run(200ms);
  EXPECT_EQ(own.role(), StandbyRole::kMaster);
}

TEST(Election, WhoIsNotReadyDoesNotTakeOverAndSaysWhy) {
  Group group(1);
  const auto a = group.add("a", 5);
  group.of(a).set_not_ready("the plan of bus press-1 is not made");
  const auto b = group.add("b", 1);
  group.run(2s);
  EXPECT_EQ(group.masters(), Names{"b"});
  EXPECT_EQ(group.of(a).beat().not_ready, "the plan of bus press-1 is not made");
  EXPECT_EQ(group.of(b).hand_over("a", group.clock(group.node(b))),
            "a is not ready: the plan of bus press-1 is not made");
}

TEST(Election, WhoseChannelsDifferFromThoseOfTheMasterDoesNotTakeOver) {
  Election own(member("b", 1), kStart);
  own.set_not_ready("");
  StandbyMember master = member("a", 2);
  master.role = StandbyRole::kMaster;
  master.term = 1;
  master.configuration = "another";
  own.receive(master, kStart);
  EXPECT_EQ(own.not_ready(kStart), "its channels differ from those of the master a");
}

TEST(Election, NorWhenThatMasterHasLeft) {
  Election own(member("b", 1), kStart);
  own.set_not_ready("");
  StandbyMember master = member("a", 2);
  master.role = StandbyRole::kMaster;
  master.term = 1;
  master.configuration = "another";
  own.receive(master, kStart);
  Instant now = kStart;
  for (; now < kStart + 10s; now += Election::kTick) own.on_time(now);
  EXPECT_EQ(own.role(), StandbyRole::kWaiting);
  EXPECT_EQ(own.not_ready(now), "its channels differ from those of the last master a");
  own.set_configuration("another");
  for (; now < kStart + 12s; now += Election::kTick) own.on_time(now);
  EXPECT_EQ(own.role(), StandbyRole::kMaster);
}

// It releases its buses and rejoins in the same process.
TEST(Election, WhoJoinsAgainCountsAboveWhatItKnew) {
  Election before(member("b", 1), kStart);
  before.set_not_ready("");
  StandbyMember master = member("a", 2, 1);
  master.role = StandbyRole::kMaster;
  master.term = StandbyTerm{7} << 32;
  before.receive(master, kStart);
  Election own(member("b", 1, 2), kStart + 1s, before.memory());
  own.set_not_ready("");
  Instant now = kStart + 1s;
  for (; now < kStart + 12s; now += Election::kTick) own.on_time(now);
  ASSERT_EQ(own.role(), StandbyRole::kMaster);
  EXPECT_EQ(number_of(own.term()), 8u);
  // That master was disconnected all the time, so its last terms are unknown.
  own.receive(member("a", 2, 3), now);
  own.on_time(now);
  EXPECT_GE(number_of(own.term()), 7 + (now - kStart) / Election::kTermTime);
}

// On a busy machine the handshake of two members can take seconds.
TEST(Election, WhoJoinsAgainAwaitsThoseThatWereAlive) {
  Election before(member("b", 1), kStart);
  before.receive(member("a", 2), kStart);
  for (const bool is_lost : {false, true}) {
    Election own(member("b", 1, 2), kStart, before.memory());
    own.set_not_ready("");
    if (is_lost) own.lost("a", kStart);
    const Duration limit = is_lost ? Election::kSettle : Election::kRejoin;
    Instant now = kStart;
    for (; now < kStart + limit; now += Election::kTick) own.on_time(now);
    EXPECT_EQ(own.role(), StandbyRole::kWaiting);
    own.on_time(now);
    EXPECT_EQ(own.role(), StandbyRole::kMaster) << is_lost;
  }
}

TEST(Election, NobodyHandsOverToAMemberThatHasJustHandedOver) {
  Election own(member("b", 1), kStart);
  own.set_not_ready("");
  StandbyMember old = member("a", 2);
  old.role = StandbyRole::kReleased;
  old.term = StandbyTerm{1} << 32;
  old.successor = "b";
  own.receive(old, kStart);
  ASSERT_EQ(own.role(), StandbyRole::kMaster);
  EXPECT_EQ(own.hand_over("", kStart), "nobody else is ready");
}

TEST(Election, APlannedHandOverLeavesNoTimeWithoutAMaster) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  const auto term = group.of(a).term();
  ASSERT_EQ(group.of(a).hand_over("b", group.clock(group.node(a))), std::nullopt);
  EXPECT_TRUE(group.of(a).serves(group.clock(group.node(a)))) << "until it has let go";
  group.run(20ms);
  group.of(a).released(group.clock(group.node(a)));
  EXPECT_FALSE(group.of(a).serves(group.clock(group.node(a))));
  group.run(10ms);
  EXPECT_EQ(group.masters(), Names{"b"});
  EXPECT_GT(group.of(b).term(), term);
  group.run(2s);
  EXPECT_EQ(group.masters(), Names{"b"}) << "it does not come back by itself";
}

TEST(Election, AHandOverToOneThatDiesEndsWithTheOldMaster) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  ASSERT_EQ(group.of(a).hand_over("", group.clock(group.node(a))), std::nullopt);
  group.kill(b);
  group.run(1s);
  EXPECT_EQ(group.masters(), Names{"a"});
  group.restart(b);
  group.run(2s);
  ASSERT_EQ(group.of(a).hand_over("b", group.clock(group.node(a))), std::nullopt);
  group.of(a).released(group.clock(group.node(a)));
  group.kill(b);
  group.run(Election::kHandOver + 500ms);
  EXPECT_EQ(group.masters(), Names{"a"});
}

TEST(Election, OfTwoMastersThatMeetTheOneWithTheSmallerTermStepsBackWithinABeat) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  group.part(a, b);
  group.run(5s);
  EXPECT_EQ(group.masters(), (Names{"a", "b"}));
  group.heal();
  group.run(Election::kBeat + 5ms);
  EXPECT_EQ(group.masters(), Names{"b"});
}

// For suspensions from 1 ms to 3 s.
TEST(Election, AMasterThatStoodStillServesNothingBeforeItHasListened) {
  for (Duration still = 1ms; still < 3s; still += 7ms) {
    Group group(static_cast<std::uint64_t>(still.count()));
    const auto a = group.add("a", 2);
    group.add("b", 1);
    group.run(2s);
    group.stop(a, still);
    group.run(still + 1s);
    EXPECT_EQ(group.masters().size(), 1u) << still.count();
    EXPECT_LE(group.longest_two, 3ms) << still.count();  // the delay of a message
  }
}

TEST(Election, AMasterWhoseGroupKnowsAGreaterTermTakesAGreaterOne) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  const auto c = group.add("c", 0);
  group.run(2s);
  group.part(a, b);
  group.part(a, c);
  group.run(1s);
  const auto seen = group.of(b).term();
  group.kill(b);
  group.run(100ms);
  group.heal();  // before c takes over
  group.run(500ms);
  EXPECT_EQ(group.masters(), Names{"a"});
  EXPECT_GT(number_of(group.of(a).term()), number_of(seen));
}

// Two that took over without seeing each other publish the same numbers.
TEST(Election, AMasterThatHearsOfAnotherTermOfItsNumberTakesALaterOne) {
  Group group(1);
  const auto a = group.add("a", 3);
  const auto b = group.add("b", 2);
  const auto c = group.add("c", 1);
  group.run(2s);
  group.part(a, b);
  group.part(a, c);
  group.part(b, c);
  group.run(3s);
  ASSERT_EQ(group.masters(), (Names{"a", "b", "c"}));
  const auto number = number_of(group.of(b).term());
  ASSERT_EQ(number_of(group.of(c).term()), number);
  group.heal();
  group.run(1s);
  const auto masters = group.masters();
  ASSERT_EQ(masters.size(), 1u);
  ASSERT_NE(masters[0], "a") << "its term was the smallest";
  EXPECT_GT(number_of(group.of(masters[0] == "b" ? b : c).term()), number);
}

// It may have been master and stores nothing.
TEST(Election, AMasterTakesALaterTermWhenAMemberThatNobodyHeardRestarts) {
  for (const bool heard : {true, false}) {
    Group group(1);
    const auto a = group.add("a", 2);
    const auto b = group.add("b", 1);
    group.run(2s);
    const auto first = number_of(group.of(a).term());
    if (!heard) {
      group.part(a, b);
      group.run(2s);
      ASSERT_EQ(group.masters(), (Names{"a", "b"}));
      ASSERT_GT(number_of(group.of(b).term()), first);
    }
    group.kill(b);
    group.of(a).lost("b", group.clock(group.node(a)));
    group.run(1s);
    group.heal();
    group.restart(b);
    group.run(3s);
    EXPECT_EQ(group.masters(), Names{"a"});
    if (heard) {
      EXPECT_EQ(number_of(group.of(a).term()), first);
    } else {
      EXPECT_GT(number_of(group.of(a).term()), first + 1) << "and thus than that of b";
    }
  }
}

TEST(Election, TheSamplesOfALaterTermHaveGreaterNumbers) {
  const auto term = [](std::uint32_t number) { return StandbyTerm{number} << 32 | 0xabcd; };
  EXPECT_EQ(sequences_of(0), 0u);
  EXPECT_EQ(sequences_of(term(1)), 0u)
      << "a group that has had one master counts as a bridge alone";
  EXPECT_EQ(sequences_of(term(2)), std::uint64_t{1} << 32);
  EXPECT_GT(sequences_of(term(8)), sequences_of(term(7)));
  EXPECT_LT(sequences_of(term(0xffffffff)), std::uint64_t{1} << 63) << "a column of a database";
}

// The faults of a day in some minutes. FIELDCAST_SEEDS sets the number of seeds.
TEST(Election, NeverTwoMastersOfOneTermAndOneMasterWhenAllIsWell) {
  const char* const wanted = std::getenv("FIELDCAST_SEEDS");
  const int seeds = wanted == nullptr ? 60 : std::atoi(wanted);
  for (int seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(seed);
    Group group(static_cast<std::uint64_t>(seed));
    auto pick = [&](int least, int most) {
      return std::uniform_int_distribution<>(least, most)(group.random());
    };
    const int members = pick(2, 4);
    for (int i = 0; i < members; ++i)
      group.add(std::string(1, static_cast<char>('a' + i)), pick(0, 3),
                std::chrono::seconds{pick(-1000, 1000)}, 1 + pick(-10, 10) / 1000.0);
    const auto any = [&] { return static_cast<std::size_t>(pick(0, members - 1)); };
    for (int trouble = 0; trouble < 40; ++trouble) {
      group.loss = pick(0, 3) == 0 ? 0.3 : 0.05;
      group.twice = 0.1;
      group.most_delay = std::chrono::milliseconds{pick(1, 80)};
      switch (pick(0, 5)) {
        case 0: group.kill(any()); break;
        case 1: group.restart(any()); break;
        case 2: group.stop(any(), std::chrono::milliseconds{pick(1, 4000)}); break;
        case 3: {
          const auto a = any();
          const auto b = any();
          if (a != b) group.part(a, b);
          break;
        }
        case 4: group.heal(); break;
        default: break;
      }
      group.run(std::chrono::milliseconds{pick(1, 2000)});
      ASSERT_EQ(group.fault, "");
    }
    group.heal();
    group.loss = group.twice = 0;
    group.most_delay = 2ms;
    for (std::size_t i = 0; i < static_cast<std::size_t>(members); ++i) {
      if (!group.node(i).election) group.restart(i);
    }
    group.run(8s);
    EXPECT_EQ(group.masters().size(), 1u);
    ASSERT_EQ(group.fault, "");
  }
}

}  // namespace
}  // namespace fieldcast

// Tests the later terms that a master uses because an unseen member may have been master and
// readers may have followed it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "tests/bridge/standby/election_group.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using election_group::Group;
using Members = std::vector<std::string>;

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
  ASSERT_GT(others, number_of(group.of(a).term()) + 16);
  group.kill(b);
  group.of(a).readers_came(group.clock(group.node(a)));
  group.run(Election::kReturn + 1s);
  EXPECT_GT(number_of(group.of(a).term()), others);
}

// Members unseen by a master die, restart, take over, hand over, and use later terms, also for
// their readers. FIELDCAST_SEEDS sets the number of runs.
class OutOfSight {
 public:
  explicit OutOfSight(std::uint64_t seed) : group_(seed), members_(pick(2, 4)) {
    for (std::size_t i = 0; i < members_; ++i)
      group_.add(std::string(1, static_cast<char>('a' + i)), i == 0 ? 9 : pick<int>(0, 3));
    group_.run(2s);
    for (std::size_t i = 1; i < members_; ++i) group_.part(0, i);
  }
  std::uint32_t trouble(int times) {
    std::uint32_t most = 0;
    for (int i = 0; i < times; ++i) {
      const auto any = pick<std::size_t>(1, members_ - 1);
      if (!group_.node(any).election)
        group_.restart(any);
      else if (const int what = pick(0, 3); what == 0)
        (void)group_.of(any).hand_over("", clock(any));
      else if (what == 1)
        group_.of(any).readers_came(clock(any));
      else
        group_.kill(any);
      for (Duration left = std::chrono::milliseconds{pick(20, 1500)}; left > 0ms; left -= 20ms) {
        group_.run(20ms);
        for (std::size_t m = 1; m < members_; ++m) most = std::max(most, look(m));
      }
    }
    for (std::size_t m = 1; m < members_; ++m) group_.kill(m);
    return most;
  }
  Group& group() { return group_; }
  Election& master() { return group_.of(0); }
  [[nodiscard]] Instant clock(std::size_t index) { return group_.clock(group_.node(index)); }

 private:
  template <class T = int>
  T pick(T least, T most) {
    return std::uniform_int_distribution<T>(least, most)(group_.random());
  }
  // Acts as the bridge: it hands over immediately, and restarts after it stepped back.
  std::uint32_t look(std::size_t index) {
    if (!group_.node(index).election) return 0;
    Election& election = group_.of(index);
    if (election.role() == StandbyRole::kHandingOver) election.released(clock(index));
    const bool was_master = election.term() != 0;
    if (was_master && election.role() == StandbyRole::kWaiting) group_.restart(index);
    return number_of(group_.of(index).term());
  }

  Group group_;
  std::size_t members_;
};

int seeds() {
  const char* const wanted = std::getenv("FIELDCAST_SEEDS");
  return wanted == nullptr ? 60 : std::atoi(wanted);
}

TEST(Election, ATermForReadersIsAboveAllThatWereTakenOutOfSight) {
  for (int seed = 1; seed <= seeds(); ++seed) {
    OutOfSight others(static_cast<std::uint64_t>(seed));
    const auto most = others.trouble(5 + seed % 60);
    others.master().readers_came(others.clock(0));
    others.group().run(Election::kReturn + 1s);
    ASSERT_GT(number_of(others.master().term()), most) << seed;
  }
}

TEST(Election, WhoRestartsIsCountedAboveWithAllThatItMayHaveHeardOf) {
  for (int seed = 1; seed <= seeds(); ++seed) {
    OutOfSight others(static_cast<std::uint64_t>(seed));
    const auto most = others.trouble(5 + seed % 60);
    others.group().run(1s);
    others.group().heal();
    others.group().restart(1);
    others.group().run(1s);
    ASSERT_GT(number_of(others.master().term()), most) << seed;
  }
}

// However often members restart: four numbers per second, for 17 years.
TEST(Election, NumbersGrowNoFasterThanTimePasses) {
  Group group(1);
  const auto a = group.add("a", 2);
  const auto b = group.add("b", 1);
  group.run(2s);
  const auto first = number_of(group.of(a).term());
  const Instant begun = group.now();
  for (int lives = 0; lives < 100; ++lives) {
    group.kill(b);
    group.run(Election::kLease + std::chrono::milliseconds{400 + lives * 7});
    group.restart(b);
    group.run(200ms);
  }
  const auto grown = number_of(group.of(a).term()) - first;
  EXPECT_GT(grown, 100u);
  EXPECT_LE(grown, (group.now() - begun) / Election::kTermTime);
  constexpr Duration kYear = 24h * 365;
  EXPECT_GE(kMostTerms / (kYear / Election::kTermTime), 17);
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
  now += 4s;  // b restarted and may have been master
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

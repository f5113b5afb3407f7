#include "bridge/standby/bus_claims.hpp"

#include <gmock/gmock.h>

#include <list>

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Domain {
  struct Bridge {
    std::string id;
    BusClaims claims;
    [[nodiscard]] BridgeClaims said() const { return {id, "host", "", {}, claims.buses()}; }
  };
  Bridge& add(const std::string& id, std::int64_t since, std::vector<std::string> buses = {"bus"}) {
    Bridge& made = bridges.emplace_back(Bridge{id, BusClaims(id)});
    made.claims.want(buses, UtcTime{since});
    return made;
  }
  void tell() {
    for (Bridge& to : bridges) {
      for (const Bridge& from : bridges) {
        if (from.id != to.id) to.claims.receive(from.id, from.said());
      }
    }
  }
  void come_to_rest() {
    for (bool changed = true; changed; tell()) {
      changed = false;
      tell();
      for (Bridge& bridge : bridges) changed |= bridge.claims.decide(now);
    }
  }
  [[nodiscard]] std::vector<std::string> serving(const std::string& bus = "bus") const {
    std::vector<std::string> ids;
    for (const Bridge& bridge : bridges) {
      if (bridge.claims.serves(bus)) ids.push_back(bridge.id);
    }
    return ids;
  }
  std::list<Bridge> bridges;
  Instant now{};
};

TEST(BusClaims, ABridgeAloneServesWhatItWants) {
  Domain domain;
  domain.add("a", 5, {"one", "two"});
  domain.come_to_rest();
  EXPECT_THAT(domain.serving("one"), ElementsAre("a"));
  EXPECT_THAT(domain.serving("two"), ElementsAre("a"));
  EXPECT_THAT(domain.serving("three"), IsEmpty());
}

TEST(BusClaims, ABusIsWantedElsewhereAlsoByAMemberOfTheGroup) {
  BusClaims own("own");
  own.set_group("g");
  own.want({"one", "two"}, UtcTime{1});
  EXPECT_FALSE(own.are_wanted_elsewhere());
  BridgeClaims other{"other", "host", "", {}, {{"three", {}}}, "g"};
  own.receive("other", other);
  EXPECT_FALSE(own.are_wanted_elsewhere());
  other.buses["two"] = {};
  own.receive("other", other);
  EXPECT_TRUE(own.are_wanted_elsewhere());
  own.set_alive("other", false);
  EXPECT_FALSE(own.are_wanted_elsewhere());
}

TEST(BusClaims, WhoComesLaterWaitsAndKnowsForWhom) {
  Domain domain;
  auto& first = domain.add("first", 9);
  domain.come_to_rest();
  auto& later = domain.add("later", 5);  // by a clock that is behind
  domain.come_to_rest();
  EXPECT_THAT(domain.serving(), ElementsAre("first"));
  ASSERT_TRUE(later.claims.rival("bus"));
  EXPECT_EQ(later.claims.rival("bus")->bridge, "first");
  EXPECT_FALSE(first.claims.rival("bus"));
}

TEST(BusClaims, OfTwoThatBeginTogetherOneServes) {
  for (const auto& [a, b, winner] :
       {std::tuple(1, 2, "a"), std::tuple(2, 1, "b"), std::tuple(3, 3, "a")}) {
    Domain domain;
    domain.add("a", a);
    domain.add("b", b);
    domain.come_to_rest();
    EXPECT_THAT(domain.serving(), ElementsAre(winner));
  }
}

TEST(BusClaims, TwoThatServedBeforeTheyMetBothGoOnAndKnowIt) {
  Domain domain;
  auto& a = domain.add("a", 7);
  auto& b = domain.add("b", 6);
  a.claims.decide({}), b.claims.decide({});
  EXPECT_THAT(domain.serving(), ElementsAre("a", "b"));
  domain.tell();
  EXPECT_THAT(a.claims.contested(), ElementsAre("bus"));
  domain.come_to_rest();
  EXPECT_THAT(domain.serving(), ElementsAre("a", "b"));
  EXPECT_THAT(a.claims.contested(), ElementsAre("bus"));
  EXPECT_THAT(b.claims.contested(), ElementsAre("bus"));
}

TEST(BusClaims, AForgedClaimTakesNoBusFromTheBridgeThatServesIt) {
  BusClaims own("m");
  own.want({"bus"}, UtcTime{10});
  ASSERT_TRUE(own.decide({}));
  for (const bool serving : {true, false}) {
    own.receive("a", {"m", "host", "", UtcTime{1}, {{"bus", {UtcTime{1}, serving}}}});
    EXPECT_FALSE(own.decide({}));
    EXPECT_TRUE(own.serves("bus"));
  }
}

TEST(BusClaims, AForgedClaimThatOnlyWaitsKeepsAStartingBridgeForSecondsOnly) {
  for (const bool standing_by : {false, true}) {
    BusClaims own("m");
    own.set_standing_by(standing_by);
    own.want({"bus"}, UtcTime{10});
    own.receive("a", {"forged", "host", "", UtcTime{1}, {{"bus", {UtcTime{1}, false}}}});
    EXPECT_FALSE(own.decide(Instant{}));
    EXPECT_FALSE(own.decide(Instant{} + BusClaims::kMostUnserved - Duration{1}));
    EXPECT_EQ(own.rival("bus")->bridge, "forged");
    own.set_standing_by(false);
    EXPECT_TRUE(own.decide(Instant{} + BusClaims::kMostUnserved)) << "a takeover does not wait";
    EXPECT_TRUE(own.serves("bus"));
    EXPECT_THAT(own.contested(), IsEmpty());
  }
}

TEST(BusClaims, TheTimeInWhichNobodyServesBeginsAgainWithEachThatServed) {
  BusClaims own("m");
  const auto claims = [&](bool serving) {
    own.receive("a", {"other", "host", "", UtcTime{1}, {{"bus", {UtcTime{1}, serving}}}});
  };
  own.want({"bus"}, UtcTime{10});
  claims(false);
  EXPECT_FALSE(own.decide(Instant{}));
  claims(true);
  EXPECT_FALSE(own.decide(Instant{} + 2 * BusClaims::kMostUnserved));
  claims(false);
  EXPECT_FALSE(own.decide(Instant{} + 3 * BusClaims::kMostUnserved));
  EXPECT_TRUE(own.decide(Instant{} + 4 * BusClaims::kMostUnserved));
}

TEST(BusClaims, TheTimeInWhichNobodyServesBeginsAgainForABusThatWasRemoved) {
  BusClaims own("m");
  own.receive("a", {"other", "host", "", UtcTime{1}, {{"bus", {UtcTime{1}, false}}}});
  own.want({"bus"}, UtcTime{10});
  EXPECT_FALSE(own.decide(Instant{}));
  own.want({}, UtcTime{11});
  own.want({"bus"}, UtcTime{12});
  const Instant later = Instant{} + 10 * BusClaims::kMostUnserved;
  EXPECT_FALSE(own.decide(later)) << "the other bridge has wanted it longer";
  EXPECT_TRUE(own.decide(later + BusClaims::kMostUnserved));
}

TEST(BusClaims, WhoWaitsTakesOverWhenTheOtherHasLeftAndOneOfSeveral) {
  Domain domain;
  domain.add("first", 1);
  domain.come_to_rest();
  domain.add("second", 3);
  domain.add("third", 2);
  domain.come_to_rest();
  EXPECT_THAT(domain.serving(), ElementsAre("first"));
  domain.bridges.pop_front();
  for (auto& bridge : domain.bridges) bridge.claims.forget("first");
  domain.come_to_rest();
  EXPECT_THAT(domain.serving(), ElementsAre("third"));
}

TEST(BusClaims, WhoIsSilentIsNotARivalAndTakesNoBusBackWhenItIsReceived) {
  Domain domain;
  domain.add("first", 1);
  domain.come_to_rest();
  auto& later = domain.add("later", 2);
  domain.come_to_rest();
  later.claims.set_alive("first", false);
  EXPECT_TRUE(later.claims.decide({}));
  EXPECT_TRUE(later.claims.serves("bus"));
  later.claims.set_alive("first", true);  // it was alive and serving all the time
  EXPECT_FALSE(later.claims.decide({}));
  EXPECT_TRUE(later.claims.serves("bus"));
  EXPECT_THAT(later.claims.contested(), ElementsAre("bus"));
}

TEST(BusClaims, ABusThatIsNotWantedAnyMoreIsFree) {
  Domain domain;
  auto& first = domain.add("first", 1, {"bus", "other"});
  domain.come_to_rest();
  domain.add("later", 2);
  domain.come_to_rest();
  first.claims.want({"other"}, UtcTime{3});
  domain.come_to_rest();
  EXPECT_THAT(domain.serving("bus"), ElementsAre("later"));
  EXPECT_THAT(domain.serving("other"), ElementsAre("first"));
  first.claims.want({"bus", "other"}, UtcTime{4});
  domain.come_to_rest();
  EXPECT_THAT(domain.serving("bus"), ElementsAre("later"));
}

TEST(BusClaims, BridgesOfOneStandbyGroupAreNoRivalsButOthersAre) {
  BusClaims own("a");
  own.set_group("g");
  own.want({"bus"}, UtcTime{10});
  BridgeClaims other{"b", "host", "", {}, {{"bus", {UtcTime{1}, true}}}, "g"};
  own.receive("b", other);
  EXPECT_EQ(own.rival("bus"), std::nullopt);
  other.group = "another";
  own.receive("b", other);
  EXPECT_TRUE(own.rival("bus"));
  other.group = "";
  own.receive("b", other);
  EXPECT_TRUE(own.rival("bus"));
}

TEST(BusClaims, CountsMembersOfItsGroupThatAreNotHeardThere) {
  BusClaims own("a");
  own.set_group("g");
  own.receive("1", {"b", "host", "", {}, {}, "g"});
  own.receive("2", {"c", "host", "", {}, {}, "g"});
  own.receive("3", {"d", "host", "", {}, {}, "another"});
  EXPECT_EQ(own.members_beside({}), 2u);
  EXPECT_EQ(own.members_beside({"b", "e"}), 1u);
  own.set_alive("2", false);
  EXPECT_EQ(own.members_beside({"b"}), 0u);
}

TEST(BusClaims, OfTwoMembersOfOneNameTheOneThatServesOrWasFirstGoesOn) {
  BusClaims claims("b");
  claims.set_group("g");
  const BridgeClaims own{"line-7", "host", "", UtcTime{20}, {}, "g"};
  EXPECT_FALSE(claims.namesake(own));
  claims.receive("a", {"line-8", "host", "", UtcTime{10}, {}, "g"});
  claims.receive("c", {"line-7", "host", "", UtcTime{10}, {}, "another"});
  EXPECT_FALSE(claims.namesake(own));
  claims.receive("d", {"line-7", "there", "", UtcTime{10}, {}, "g"});
  ASSERT_TRUE(claims.namesake(own));
  EXPECT_TRUE(claims.namesake(own)->goes_first);
  EXPECT_EQ(claims.namesake(own)->claims.host, "there");
  claims.receive("d", {"line-7", "there", "", UtcTime{30}, {}, "g"});
  EXPECT_FALSE(claims.namesake(own)->goes_first);
  claims.receive("d", {"line-7", "there", "", UtcTime{30}, {{"bus", {UtcTime{30}, true}}}, "g"});
  EXPECT_TRUE(claims.namesake(own)->goes_first) << "it serves";
  claims.set_alive("d", false);
  EXPECT_FALSE(claims.namesake(own));
}

TEST(BusClaims, WhoStandsByServesNothing) {
  BusClaims own("a");
  own.set_group("g");
  own.set_standing_by(true);
  own.want({"bus"}, UtcTime{1});
  EXPECT_FALSE(own.decide({}));
  EXPECT_FALSE(own.serves("bus"));
  own.set_standing_by(false);
  EXPECT_TRUE(own.decide({}));
  EXPECT_TRUE(own.serves("bus"));
}

}  // namespace
}  // namespace fieldcast

#include <gtest/gtest.h>

#include <set>

#include "bridge/station/station.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

DdsSite site(const std::string& name) {
  DdsSite spec{name, loopback()};
  spec.dds.partition = name;
  return spec;
}

class SitesTest : public ::testing::Test {
 protected:
  const std::string bus_ = bus_name("line");
  Obedient north_{bus_, 2, site("north").dds}, south_{bus_, 2, site("south").dds};
  Station sites_{{site("north"), site("south")}, "both"};
};

TEST_F(SitesTest, ValuesOfBusesWithOneNameAreDistinguished) {
  Collected<StationSample> samples;
  Collected<StationChannel> channels;
  sites_.subscribe_channels([&](const StationChannel& channel) { channels.add(channel); });
  sites_.subscribe_samples([&](const StationSample& sample) { samples.add(sample); });
  north_.link.publish(bus_, std::vector<Sample>{good(0, 1.0), good(1, 2.0)}, both_clocks());
  south_.link.publish(bus_, std::vector<Sample>{good(0, 3.0), good(1, 4.0)}, both_clocks());
  const auto values = [&] {
    std::map<std::string, Value> last;
    for (const StationSample& sample : samples.all()) last[sample.path()] = sample.value;
    return last;
  };
  ASSERT_TRUE(eventually([&] { return values().size() == 4 && channels.size() == 4; }));
  EXPECT_EQ(values(), (std::map<std::string, Value>{{"north:" + bus_ + "/d/c0", 1.0},
                                                    {"north:" + bus_ + "/d/c1", 2.0},
                                                    {"south:" + bus_ + "/d/c0", 3.0},
                                                    {"south:" + bus_ + "/d/c1", 4.0}}));
  std::set<std::string> bridges;
  for (const StationChannel& channel : channels.all()) bridges.insert(channel.bridge);
  EXPECT_EQ(bridges, (std::set<std::string>{"north:test", "south:test"}));
}

TEST_F(SitesTest, ACommandGoesToTheSiteThatItsBusNames) {
  Collected<StationResult> results;
  sites_.on_result([&](const StationResult& result) { results.add(result); });
  const auto outcome = sites_.execute(write_running("south:" + bus_));
  ASSERT_TRUE(outcome) << to_text(outcome);
  EXPECT_EQ(outcome->bus, "south:" + bus_);
  EXPECT_EQ(south_.received.commands.size(), 1u);
  EXPECT_EQ(north_.received.commands.size(), 0u);
  EXPECT_TRUE(sites_.write("north:" + bus_ + "/d/c0", true));
  EXPECT_EQ(north_.received.commands.size(), 1u);
  ASSERT_TRUE(eventually([&] { return results.size() == 2; }));
  EXPECT_EQ(results.all()[1].bus, "north:" + bus_);
  EXPECT_NE(results.all()[0].request_id, results.all()[1].request_id);
}

TEST_F(SitesTest, ABusOfNoSiteIsRefusedImmediately) {
  for (const std::string& bus : {bus_, "east:" + bus_, "north" + bus_}) {
    const auto outcome = sites_.execute(write_running(bus));
    ASSERT_FALSE(outcome) << bus;
    EXPECT_EQ(outcome.error(), StationFault::kNoSite) << bus;
  }
}

TEST_F(SitesTest, AnActionOnAnAlarmGoesToItsSite) {
  north_.received.answer_action = [this](const AlarmAction& action) {
    CommandResult result;
    result.requester = action.requester;
    result.request_id = action.request_id;
    result.state = CommandState::kDone;
    result.received = result.started = result.completed = both_clocks().instant;
    north_.link.complete(action.alarm.bus, result, both_clocks());
  };
  AlarmAction action;
  action.alarm = {"north:" + bus_, "d", "c0", LimitKind::kHigh};
  action.by = "anna";
  const auto outcome = sites_.execute(action);
  ASSERT_TRUE(outcome) << to_text(outcome);
  EXPECT_EQ(outcome->bus, "north:" + bus_);
  EXPECT_EQ(north_.received.actions.size(), 1u);
  EXPECT_EQ(south_.received.actions.size(), 0u);
}

TEST_F(SitesTest, AnInterestIsDeclaredWhereItsPatternMatches) {
  using namespace std::chrono_literals;
  sites_.declare_interest("south:line*", 1s);
  sites_.declare_interest("*/d/c1", 2s);
  const auto patterns = [](Received& received) {
    std::set<std::string> all;
    for (const Interest& interest : received.interests.all()) all.insert(interest.pattern);
    return all;
  };
  EXPECT_TRUE(eventually([&] {
    return patterns(south_.received) == std::set<std::string>{"line*", "*/d/c1"} &&
           patterns(north_.received) == std::set<std::string>{"*/d/c1"};
  }));
}

TEST(PatternAtSite, NamesTheSiteOrMatchesIt) {
  EXPECT_EQ(pattern_at_site("line/m/t", ""), "line/m/t");  // the only one
  EXPECT_EQ(pattern_at_site("north:line/m/t", "north"), "line/m/t");
  EXPECT_EQ(pattern_at_site("north:line/m/t", "south"), std::nullopt);
  EXPECT_EQ(pattern_at_site("*:line", "south"), "line");
  EXPECT_EQ(pattern_at_site("n*:line", "south"), std::nullopt);
  EXPECT_EQ(pattern_at_site("*", "south"), "*");
  EXPECT_EQ(pattern_at_site("*/m/t", "south"), "*/m/t");
  EXPECT_EQ(pattern_at_site("nor*", "north"), "*");
  EXPECT_EQ(pattern_at_site("nor*", "south"), std::nullopt);
  EXPECT_EQ(pattern_at_site("n*r*7/m", "north"), "*7/m");
  EXPECT_EQ(pattern_at_site("line", "north"), std::nullopt);
}

TEST(Sites, OneWithoutANameIsAStation) {
  const std::string bus = bus_name("alone");
  Obedient bridge(bus);
  Collected<StationChannel> channels;
  Station sites({DdsSite{{}, loopback()}}, "one");
  sites.subscribe_channels([&](const StationChannel& channel) {
    if (channel.bus == bus) channels.add(channel);
  });
  EXPECT_TRUE(sites.execute(write_running(bus)));
  EXPECT_TRUE(eventually([&] { return channels.size() == 1; }));
}

TEST(Sites, AFaultNamesItsSite) {
  DdsSite bad = site("south");
  bad.dds.interfaces = {"192.0.2.1"};
  try {
    const Station sites({site("north"), bad}, "both");
    FAIL();
  } catch (const DdsError& error) {
    EXPECT_EQ(std::string(error.what()),
              "site south: dds: no interface of this machine has the address 192.0.2.1");
  }
}

}  // namespace
}  // namespace fieldcast::testing

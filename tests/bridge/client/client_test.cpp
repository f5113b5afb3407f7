// Tests the public library, <fieldcast/station.hpp>, with bridge links on the loopback.
#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include "fieldcast/station.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

api::Domain domain_of(const DdsSpec& spec, const std::string& name = {}) {
  api::Domain domain;
  domain.name = name;
  domain.domain = spec.domain;
  domain.partition = spec.partition;
  return domain;
}

class Client : public ::testing::Test {
 protected:
  void publish(std::vector<Sample> samples) { served_.link.publish(bus_, samples, both_clocks()); }

  const std::string bus_ = bus_name("line");
  Obedient served_{bus_, 2, loopback()};
  api::Station station_{"client", domain_of(loopback())};
};

TEST_F(Client, ReceivesTheChannelsOfItsPattern) {
  Collected<api::Sample> all, one;
  const auto everything = station_.subscribe("*", [&](const api::Sample& s) { all.add(s); });
  const auto selected =
      station_.subscribe(bus_ + "/d/c1", [&](const api::Sample& s) { one.add(s); });
  publish({good(0, 1.5), good(1, 2.5)});
  ASSERT_TRUE(eventually([&] { return all.size() == 2 && one.size() == 1; }));
  EXPECT_EQ(one.all()[0].path.text(), bus_ + "/d/c1");
  EXPECT_EQ(api::to_text(one.all()[0].value), "2.5");
  EXPECT_EQ(one.all()[0].quality, api::Quality::kGood);
  EXPECT_LT(api::age(one.all()[0]), 10s);
}

TEST_F(Client, ALaterSubscriptionBeginsWithTheLastValues) {
  Collected<api::Sample> first, second;
  const auto early = station_.subscribe("*", [&](const api::Sample& s) { first.add(s); });
  publish({good(0, 7.0)});
  ASSERT_TRUE(eventually([&] { return first.size() == 1; }));
  const auto late = station_.subscribe("*", [&](const api::Sample& s) { second.add(s); });
  EXPECT_EQ(second.size(), 1u);
}

TEST_F(Client, ASubscriptionEndsWhenItIsDestroyed) {
  std::atomic<int> ended = 0;
  Collected<api::Sample> kept;
  const auto stays = station_.subscribe("*", [&](const api::Sample& s) { kept.add(s); });
  {
    const auto brief = station_.subscribe("*", [&](const api::Sample&) { ++ended; });
  }
  publish({good(0, 1.0)});
  ASSERT_TRUE(eventually([&] { return kept.size() == 1; }));
  EXPECT_EQ(ended, 0);
}

TEST_F(Client, AHandlerMayEndItsOwnSubscription) {
  std::atomic<int> calls = 0;
  Collected<api::Sample> kept;
  api::Subscription once;
  once = station_.subscribe("*", [&](const api::Sample&) {
    ++calls;
    once.end();
  });
  const auto stays = station_.subscribe("*", [&](const api::Sample& s) { kept.add(s); });
  publish({good(0, 1.0)});
  ASSERT_TRUE(eventually([&] { return kept.size() == 1; }));
  publish({good(0, 2.0, 2)});
  ASSERT_TRUE(eventually([&] { return kept.size() == 2; }));
  EXPECT_EQ(calls, 1);
}

TEST_F(Client, ReceivesTheCatalogueAndItsBridge) {
  Collected<api::Channel> channels;
  const auto catalogue = station_.catalogue("*", [&](const api::Channel& c) { channels.add(c); });
  ASSERT_TRUE(eventually([&] { return channels.size() == 2; }));
  EXPECT_EQ(channels.all()[0].bridge, "test");
  EXPECT_EQ(channels.all()[0].address.substr(0, 8), "holding:");
}

TEST_F(Client, AWriteHasItsOneResult) {
  const api::Result result = station_.write(bus_ + "/d/c0", true);
  EXPECT_TRUE(result.ok()) << api::to_text(result);
  ASSERT_EQ(served_.received.commands.size(), 1u);
}

TEST_F(Client, AWriteToNoBusIsNotSent) {
  api::CommandOptions soon;
  soon.wait_for_bridge = 10ms;
  const api::Result none = station_.write("nowhere/d/c0", true, soon);
  EXPECT_EQ(none.outcome, api::Outcome::kNotSent);
  EXPECT_FALSE(none.reason.empty());
  EXPECT_EQ(station_.write("not a path", true).outcome, api::Outcome::kNotSent);
}

TEST_F(Client, AcquiresOneChannelOrAWholeDevice) {
  EXPECT_TRUE(station_.acquire(bus_ + "/d/c1").ok());
  EXPECT_TRUE(station_.acquire(bus_ + "/d").ok());
  const auto commands = served_.received.commands.all();
  ASSERT_EQ(commands.size(), 2u);
  EXPECT_EQ(std::get<ChannelTarget>(commands[0].second.target).name, "c1");
  EXPECT_EQ(std::get<ChannelTarget>(commands[1].second.target).name, "");
}

TEST_F(Client, AnInterestLastsAsLongAsItsSubscription) {
  const auto refreshes = [&] {
    std::optional<Duration> last;
    for (const Interest& interest : served_.received.interests.all()) last = interest.refresh;
    return last;
  };
  {
    const auto slow = station_.interest(bus_, 5s);
    const auto fast = station_.interest(bus_, 1s);
    EXPECT_TRUE(eventually([&] { return refreshes() == Duration{1s}; }));
  }
  EXPECT_TRUE(eventually([&] { return !refreshes(); }));
}

TEST_F(Client, AMissedRefreshIsReported) {
  BusSpec fast = bus_of(bus_ + "-fast", 1, [](std::size_t) { return Duration{100ms}; });
  served_.link.add_bus(fast);
  Collected<api::Sample> samples;
  Collected<api::Path> missed;
  api::SampleOptions options;
  options.refresh = 200ms;
  options.on_missed = [&](const api::Path& path) { missed.add(path); };
  const auto values = station_.subscribe(
      "*", [&](const api::Sample& s) { samples.add(s); }, options);
  ASSERT_TRUE(eventually([&] {
    served_.link.publish(fast.name, std::vector<Sample>{good(0, 1.0)}, both_clocks());
    return samples.size() > 0;
  }));
  EXPECT_TRUE(eventually([&] { return missed.size() > 0; }));
  EXPECT_EQ(missed.all()[0].text(), fast.name + "/d/c0");
}

TEST_F(Client, APatternThatIsNotValidIsRefused) {
  EXPECT_THROW((void)station_.subscribe("a/b/c/d", [](const api::Sample&) {}),
               std::invalid_argument);
}

TEST(ClientDomains, SeveralNeedNamesOfTheirOwn) {
  const DdsSpec spec = loopback();
  EXPECT_THROW(api::Station("x", std::vector<api::Domain>{}), api::JoinError);
  EXPECT_THROW(api::Station("x", {domain_of(spec), domain_of(spec)}), api::JoinError);
  EXPECT_THROW(api::Station("x", {domain_of(spec, "a"), domain_of(spec, "a")}), api::JoinError);
  api::Domain elsewhere = domain_of(spec);
  elsewhere.interfaces = {"203.0.113.9"};
  EXPECT_THROW(api::Station("x", elsewhere), api::JoinError);
}

TEST(ClientDomains, TheNameOfADomainComesBeforeItsBuses) {
  DdsSpec north = loopback(), south = loopback();
  north.partition = "north";
  south.partition = "south";
  const std::string bus = bus_name("line");
  Obedient in_north{bus, 1, north}, in_south{bus, 1, south};
  api::Station station("both", {domain_of(north, "north"), domain_of(south, "south")});
  Collected<api::Sample> samples;
  const auto values = station.subscribe("south:*", [&](const api::Sample& s) { samples.add(s); });
  in_north.link.publish(bus, std::vector<Sample>{good(0, 1.0)}, both_clocks());
  in_south.link.publish(bus, std::vector<Sample>{good(0, 2.0)}, both_clocks());
  ASSERT_TRUE(eventually([&] { return samples.size() == 1; }));
  EXPECT_EQ(samples.all()[0].path.text(), "south:" + bus + "/d/c0");
  EXPECT_TRUE(station.write("north:" + bus + "/d/c0", true).ok());
  EXPECT_EQ(in_north.received.commands.size(), 1u);
}

}  // namespace
}  // namespace fieldcast::testing

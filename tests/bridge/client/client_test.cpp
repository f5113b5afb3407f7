// Tests the public library, <fieldcast/station.hpp>, with bridge links on the loopback.
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <thread>

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

TEST_F(Client, AHandlerMayUseTheStation) {
  Collected<api::Channel> channels;
  Collected<std::uint64_t> lost;
  api::Subscription catalogue;
  const auto values = station_.subscribe("*", [&](const api::Sample&) {
    if (!catalogue)
      catalogue = station_.catalogue("*", [&](const api::Channel& c) { channels.add(c); });
    lost.add(station_.lost_blocks());
  });
  publish({good(0, 1.0)});
  EXPECT_TRUE(eventually([&] { return channels.size() == 2 && lost.size() == 1; }));
}

// Regression: this thread held the turn of the handler and waited for the thread of the station,
// which waited for the turn.
TEST_F(Client, AHandlerMayUseTheStationWhileItReceivesTheKnownValues) {
  std::atomic<bool> ended = false;
  std::thread publisher([&] {
    for (std::uint64_t i = 1; !ended; ++i) {
      publish({good(0, static_cast<double>(i), i)});
      std::this_thread::sleep_for(1ms);
    }
  });
  for (int round = 0; round < 20; ++round) {
    api::Station station{"client", domain_of(loopback())};
    std::atomic<int> samples = 0, channels = 0;
    const auto first = station.subscribe("*", [&](const api::Sample&) { ++samples; });
    EXPECT_TRUE(eventually([&] { return samples > 0; }));
    api::Subscription catalogue;
    const auto second = station.subscribe("*", [&](const api::Sample&) {
      if (catalogue) return;
      const int before = samples;
      (void)eventually([&] { return samples > before; });  // and then waits for this handler
      (void)station.lost_blocks();
      catalogue = station.catalogue("*", [&](const api::Channel&) { ++channels; });
    });
    EXPECT_TRUE(eventually([&] { return channels == 2; }));
  }
  ended = true;
  publisher.join();
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

TEST_F(Client, AWriteMayWaitWithoutALimit) {
  constexpr Duration kAlways = Duration::max();
  const api::CommandOptions patient{
      .lifespan = kAlways, .wait_for_bridge = kAlways, .wait_for_result = kAlways};
  const api::Result result = station_.write(bus_ + "/d/c0", true, patient);
  EXPECT_TRUE(result.ok()) << api::to_text(result);
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

TEST_F(Client, WritesAndAcquiresAtAnAddress) {
  api::Address address{.at = "holding:100", .type = "int32", .low_word_first = true};
  EXPECT_TRUE(station_.write(bus_ + "/d", address, {std::int64_t{-7}, std::int64_t{8}}).ok());
  const api::Result acquired =
      station_.acquire(bus_ + "/d", {.at = "holding:3", .type = "string(8)"}, 3);
  EXPECT_TRUE(acquired.ok()) << api::to_text(acquired);
  const auto commands = served_.received.commands.all();
  ASSERT_EQ(commands.size(), 2u);
  const Command& written = commands[0].second;
  const auto& target = std::get<AddressTarget>(written.target);
  EXPECT_EQ(target.at, "holding:100");
  EXPECT_EQ(target.encoding,
            (Encoding{.type = ValueType::kInt32, .word_order = WordOrder::kLittleEndian}));
  EXPECT_EQ(written.device, "d");
  EXPECT_EQ(written.values, (std::vector<Value>{std::int64_t{-7}, std::int64_t{8}}));
  const Command& read = commands[1].second;
  EXPECT_EQ(read.operation, Operation::kAcquire);
  EXPECT_EQ(to_text(std::get<AddressTarget>(read.target).encoding), "string(8)");
  EXPECT_EQ(read.count, 3u);
}

TEST_F(Client, AnAddressOfNoTypeOrNoDeviceIsNotSent) {
  const api::Result no_type = station_.acquire(bus_ + "/d", {.at = "holding:3", .type = "int61"});
  EXPECT_EQ(no_type.outcome, api::Outcome::kNotSent);
  EXPECT_EQ(no_type.reason.substr(0, 24), "type 'int61' is unknown;");
  for (const std::string& device : {bus_, bus_ + "/d/c0"}) {
    const api::Result no_device = station_.acquire(device, api::Address{.at = "holding:3"});
    EXPECT_EQ(no_device.outcome, api::Outcome::kNotSent) << device;
    EXPECT_FALSE(no_device.reason.empty());
  }
  EXPECT_EQ(served_.received.commands.size(), 0u);
}

TEST_F(Client, ReceivesTheReadPlanOfABusAndItsEnd) {
  PlanReport::Point point{.area = "holding", .first = 7, .count = 2, .channels = {"c0", "c1"}};
  point.worst_gap = 380ms;
  const PlanReport::Group group{.device = "d", .list = true, .period = 188ms, .points = {point}};
  served_.link.report(bus_, {.load = 0.25, .slot = 94ms, .groups = {group}}, {6});
  Collected<api::ReadPlan> plans;
  const auto watched = station_.read_plans([&](const api::ReadPlan& plan) { plans.add(plan); });
  ASSERT_TRUE(eventually([&] { return plans.size() == 1; }));
  const api::ReadPlan plan = plans.all()[0];
  EXPECT_EQ(plan.bus, bus_);
  EXPECT_EQ(plan.load, 0.25);
  EXPECT_EQ(plan.slot, 94ms);
  EXPECT_EQ(plan.in_force_since, api::Time{6ns});
  ASSERT_EQ(plan.groups.size(), 1u);
  EXPECT_EQ(plan.groups[0].device, "d");
  EXPECT_TRUE(plan.groups[0].list);
  EXPECT_EQ(plan.groups[0].period, 188ms);
  ASSERT_EQ(plan.groups[0].points.size(), 1u);
  EXPECT_EQ(plan.groups[0].points[0].area, "holding");
  EXPECT_EQ(plan.groups[0].points[0].count, 2u);
  EXPECT_EQ(plan.groups[0].points[0].channels, point.channels);
  EXPECT_EQ(plan.groups[0].points[0].worst_gap, Duration{380ms});
  served_.link.remove_bus(bus_);
  ASSERT_TRUE(eventually([&] { return plans.size() == 2; }));
  EXPECT_FALSE(plans.all()[1].present);
}

TEST_F(Client, ReceivesTheSessionsOfEngineersAndTheirEnd) {
  auto other = std::make_unique<Obedient>(bus_ + "-other");
  Collected<api::ProgrammingSession> sessions;
  const auto watched = station_.programming_sessions(
      [&](const api::ProgrammingSession& session) { sessions.add(session); });
  other->link.report(
      ProgramSessionReport{bus_, "d", ProgramSessionState::kOpen, "anna (10.0.0.7:5)", 1, 2, {3}});
  ASSERT_TRUE(eventually([&] { return sessions.size() == 1; }));
  const api::ProgrammingSession session = sessions.all()[0];
  EXPECT_EQ(session.bus + '/' + session.device, bus_ + "/d");
  EXPECT_EQ(session.state, "open");
  EXPECT_EQ(session.engineer, "anna (10.0.0.7:5)");
  EXPECT_EQ(session.bytes_to_device, 1u);
  EXPECT_EQ(session.bytes_from_device, 2u);
  EXPECT_EQ(session.since, api::Time{3ns});
  EXPECT_TRUE(session.present);
  other.reset();
  ASSERT_TRUE(eventually([&] { return sessions.size() == 2; }));
  EXPECT_FALSE(sessions.all()[1].present);
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

TEST_F(Client, AHandlerMayRenewItsOwnSubscriptionWithARefresh) {
  Collected<api::Sample> renewed;
  std::atomic<bool> is_renewed = false;
  api::Subscription values;
  values =
      station_.subscribe("*",
                         [&](const api::Sample&) {
                           if (is_renewed) return;
                           values.end();
                           values = station_.subscribe(
                               "*", [&](const api::Sample& s) { renewed.add(s); }, {.refresh = 1h});
                           is_renewed = true;
                         },
                         {.refresh = 1h});
  publish({good(0, 1.0)});
  EXPECT_TRUE(eventually([&] { return is_renewed && renewed.size() > 0; }));
}

TEST_F(Client, MissedRefreshesWithoutARefreshAreNotWatched) {
  Collected<api::Sample> samples;
  const auto values = station_.subscribe("*", [&](const api::Sample& s) { samples.add(s); },
                                         {.on_missed = [](const api::Path&) {}});
  publish({good(0, 1.0)});
  EXPECT_TRUE(eventually([&] { return samples.size() == 1; }));
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
  EXPECT_TRUE(station.acquire("south:" + bus + "/d", api::Address{.at = "holding:1"}).ok());
  EXPECT_EQ(in_south.received.commands.size(), 1u);
  Collected<std::string> plans, sessions;
  const auto planned = station.read_plans([&](const api::ReadPlan& p) { plans.add(p.bus); });
  const auto programmed =
      station.programming_sessions([&](const api::ProgrammingSession& s) { sessions.add(s.bus); });
  in_north.link.report(bus, PlanReport{}, {1});
  in_south.link.report(
      ProgramSessionReport{bus, "d", ProgramSessionState::kOpen, "anna", 0, 0, {1}});
  ASSERT_TRUE(eventually([&] { return plans.size() == 1 && sessions.size() == 1; }));
  EXPECT_EQ(plans.all()[0], "north:" + bus);
  EXPECT_EQ(sessions.all()[0], "south:" + bus);
}

TEST(ClientDomains, InterestsThatAreOneInADomainEndOneByOne) {
  DdsSpec north = loopback(), south = loopback();
  north.partition = "north";
  south.partition = "south";
  Obedient in_north{bus_name("line"), 1, north};
  api::Station station("both", {domain_of(north, "north"), domain_of(south, "south")});
  const auto refresh = [&] {
    const auto heard = in_north.received.interests.all();
    return heard.empty() ? std::nullopt : heard.back().refresh;
  };
  const auto everywhere = station.interest("*", 2s);
  {
    const auto there = station.interest("north:*", 1s);
    EXPECT_TRUE(eventually([&] { return refresh() == Duration{1s}; }));
  }
  EXPECT_TRUE(eventually([&] { return refresh() == Duration{2s}; }));
}

TEST(ClientDomains, AMissedRefreshNamesItsDomain) {
  DdsSpec north = loopback(), south = loopback();
  north.partition = "north";
  south.partition = "south";
  const std::string bus = bus_name("line");
  Received none;
  DdsLink in_south(south, "test", none.handlers());
  in_south.add_bus(bus_of(bus, 1, [](std::size_t) { return Duration{100ms}; }));
  api::Station station("both", {domain_of(north, "north"), domain_of(south, "south")});
  Collected<api::Sample> samples;
  Collected<api::Path> missed;
  const auto values = station.subscribe(
      "south:*", [&](const api::Sample& s) { samples.add(s); },
      {.refresh = 200ms, .on_missed = [&](const api::Path& path) { missed.add(path); }});
  ASSERT_TRUE(eventually([&] {
    in_south.publish(bus, std::vector<Sample>{good(0, 1.0)}, both_clocks());
    return samples.size() > 0;
  }));
  ASSERT_TRUE(eventually([&] { return missed.size() > 0; }));
  EXPECT_EQ(samples.all()[0].path.text(), "south:" + bus + "/d/c0");
  EXPECT_EQ(missed.all()[0].text(), "south:" + bus + "/d/c0");
}

}  // namespace
}  // namespace fieldcast::testing

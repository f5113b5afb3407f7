#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

TEST(DdsCommand, RunsAndItsResultComesBack) {
  const std::string bus = bus_name("command");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  const auto result = station.execute(write_running(bus));
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kDone);
  EXPECT_EQ(result->values, std::vector<Value>{true});
  EXPECT_EQ(result->bus, bus);
  EXPECT_EQ(result->requester, station.requester());
  ASSERT_EQ(bridge.received.commands.size(), 1u);
  EXPECT_EQ(bridge.received.commands.all()[0].first, bus);
}

TEST(DdsCommand, OfABusThatRestartsArriveUntilTheyAreIgnored) {
  const std::string bus = bus_name("restart");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  bridge.link.remove_bus(bus);
  const auto between = station.execute(write_running(bus));
  ASSERT_TRUE(between) << to_text(between.error());
  EXPECT_EQ(between->state, CommandState::kDone);
  bridge.link.ignore_requests(bus);
  StationCommand command = write_running(bus);
  command.lifespan = 100ms;
  const auto ignored = station.execute(command, 3s, 300ms);
  ASSERT_FALSE(ignored);
  EXPECT_EQ(ignored.error(), StationFault::kNoResult);
  EXPECT_EQ(bridge.received.commands.size(), 1u);
  bridge.link.add_bus(bus_of(bus, 1));
  EXPECT_TRUE(station.execute(write_running(bus)));
}

TEST(DdsCommand, AChannelIsWrittenByItsPath) {
  const std::string bus = bus_name("path");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  const auto result = station.write(bus + "/d/c0", 42, true);
  ASSERT_TRUE(result) << to_text(result.error());
  const Command taken = bridge.received.commands.all().back().second;
  EXPECT_EQ(taken.device, "d");
  EXPECT_EQ(std::get<ChannelTarget>(taken.target).name, "c0");
  EXPECT_EQ(taken.values, std::vector<Value>{std::int64_t{42}});
  EXPECT_TRUE(taken.verify);
  for (const std::string& path :
       {bus, bus + "/d", bus + "/d/c0/more", bus + "/d/", std::string("/d/c0")}) {
    const auto refused = station.write(path, 42);
    ASSERT_FALSE(refused) << path;
    EXPECT_EQ(refused.error(), StationFault::kNotAPath);
  }
}

TEST(DdsCommand, OfAPersonNamesThePersonAndItsResultComesBack) {
  const std::string bus = bus_name("person");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  StationCommand command = write_running(bus);
  command.person = "anna@line-7";
  const auto result = station.execute(command);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->requester, station.requester() + "/anna@line-7");
  command.person = "ben";
  const auto other = station.execute(command);
  ASSERT_TRUE(other) << to_text(other.error());
  EXPECT_EQ(bridge.received.commands.all().back().second.requester, station.requester() + "/ben");
  EXPECT_GT(other->request_id, result->request_id) << "one count for all persons";
}

TEST(DdsCommand, NamesThatFitAreCutAndOthersAreRefused) {
  const std::string bus = bus_name("names");
  Obedient bridge(bus);
  Station station(loopback(), std::string(64, 's'));
  StationCommand command = write_running(bus);
  command.person = std::string(64, 'p');
  const auto result = station.execute(command);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_LE(result->requester.size(), 128u);
  EXPECT_TRUE(result->requester.ends_with('/' + command.person));
  for (const std::string& name : {std::string(65, 'p'), std::string("a/b"), std::string("a b"),
                                  std::string("a\n"), std::string("\xC3\xA9")}) {
    command.person = name;
    const auto refused = station.execute(command);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error(), StationFault::kNoPerson);
  }
}

TEST(DdsCommand, HasTheRequestIdThatWasReservedForIt) {
  const std::string bus = bus_name("reserved");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  StationCommand command = write_running(bus);
  command.command.request_id = station.reserve_request_id();
  const auto first = station.execute(write_running(bus));
  const auto result = station.execute(command);
  ASSERT_TRUE(first && result);
  EXPECT_EQ(result->request_id, command.command.request_id);
  EXPECT_GT(first->request_id, result->request_id);
  command.command.request_id = 1'000'000;
  EXPECT_EQ(station.execute(command).error(), StationFault::kNotSent) << "it was not reserved";
}

TEST(DdsCommand, ItsOutcomeIsReported) {
  StationResult result;
  result.state = CommandState::kVerified;
  result.cause = "NONE";
  EXPECT_EQ(to_text(StationOutcome(result)), "verified");
  result.state = CommandState::kRejected;
  result.cause = "READ_ONLY";
  result.reason = "channel is read-only";
  EXPECT_EQ(to_text(StationOutcome(result)), "rejected: channel is read-only (READ_ONLY)");
  EXPECT_EQ(to_text(StationOutcome(tl::unexpected(StationFault::kNoBridge))),
            "no bridge serves the bus; it was not sent");
}

TEST(DdsCommand, AnAgeCountsFromTheArrivalOfTheLastByte) {
  StationSample sample;
  sample.acquired_at = both_clocks().utc;
  EXPECT_LT(age(sample), 10s);
  sample.acquired_at.nanoseconds -= Duration{1h}.count();
  EXPECT_GE(age(sample), 1h);
}

TEST(DdsCommand, ExpiresTheWritersLifespanAfterItWasWritten) {
  const std::string bus = bus_name("lifespan");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  for (const Duration lifespan : {2s, 30s}) {
    StationCommand command = write_running(bus);
    command.lifespan = lifespan;
    const Instant before = both_clocks().instant;
    ASSERT_TRUE(station.execute(command));
    const Instant expires = bridge.received.commands.all().back().second.expires;
    EXPECT_GE(expires, before + lifespan - 100ms);
    EXPECT_LE(expires, both_clocks().instant + lifespan + 100ms);
  }
}

TEST(DdsCommand, ForAnotherBridgesBusIsNotTaken) {
  const std::string bus = bus_name("ours");
  Obedient bridge(bus);
  bridge.claim({bus, "not-" + bus});  // so that it is sent
  Station station(loopback(), "operator");
  StationCommand foreign = write_running("not-" + bus);
  foreign.lifespan = 100ms;
  const auto nothing = station.execute(foreign, 3s, 100ms);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error(), StationFault::kNoResult);
  ASSERT_TRUE(station.execute(write_running(bus)));
  EXPECT_EQ(bridge.received.commands.size(), 1u);
}

TEST(DdsCommand, WithoutABridgeIsNotWritten) {
  DdsSpec empty = loopback();
  empty.partition = bus_name("nobody");
  Station station(empty, "operator");
  const auto result = station.execute(write_running("b"), 100ms);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(), StationFault::kNoBridge);
}

TEST(DdsCommand, WaitsForTheBridgeOfItsBus) {
  const std::string first = bus_name("first"), second = bus_name("second");
  Obedient one(first);
  Station station(loopback(), "operator");
  ASSERT_TRUE(station.execute(write_running(first)));
  const auto nobody = station.execute(write_running(second), 100ms);
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error(), StationFault::kNoBridge) << "another bridge is there";
  StationOutcome outcome = nobody;
  std::thread waiting([&] { outcome = station.execute(write_running(second), 20s); });
  Obedient other(second);
  waiting.join();
  ASSERT_TRUE(outcome) << to_text(outcome);
  EXPECT_EQ(other.received.commands.size(), 1u);
}

TEST(DdsCommand, GoesToTheMembersOfAStandbyGroupWhileNoneServes) {
  const std::string bus = bus_name("group");
  Obedient member(bus);
  member.claim({bus}, false, "pair");
  Station station(loopback(), "operator");
  EXPECT_TRUE(station.execute(write_running(bus)));
  member.claim({bus}, false, "");
  ASSERT_TRUE(eventually([&] { return !station.execute(write_running(bus), 1ms); }))
      << "who waits for another bridge takes none";
}

TEST(DdsCommand, RestartedBridgeNeverReceivesAnOldOne) {
  const std::string bus = bus_name("restart");
  Station station(loopback(), "operator");
  {
    Obedient first(bus);
    ASSERT_TRUE(station.execute(write_running(bus)));
  }
  Obedient second(bus);
  ASSERT_TRUE(station.execute(write_running(bus)));  // earlier commands would have arrived earlier
  EXPECT_EQ(second.received.commands.size(), 1u);
}

TEST(DdsCommand, MalformedIsRejectedWithAReason) {
  const std::string bus = bus_name("malformed");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  StationCommand command = write_running(bus);
  command.command.values.clear();
  const auto result = station.execute(command);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kRejected);
  EXPECT_EQ(result->cause, to_name(Cause::kWrongType));
  EXPECT_FALSE(result->reason.empty());
  EXPECT_EQ(bridge.received.commands.size(), 0u);
}

CommandResult refused_as(const Command& command, Cause cause) {
  CommandResult result = done(command);
  result.state = CommandState::kRejected;
  result.cause = cause;
  return result;
}

TEST(DdsCommand, IsSentAgainWithinItsLifespanWhenItsBusWasBeingTakenOver) {
  const std::string bus = bus_name("takeover");
  Obedient bridge(bus);
  bridge.received.answer = [&](const std::string& name, const Command& command) {
    const bool first = bridge.received.commands.size() == 1;
    bridge.link.complete(name, first ? refused_as(command, Cause::kShutdown) : done(command),
                         both_clocks());
  };
  Station station(loopback(), "operator");
  const auto result = station.execute(write_running(bus));
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kDone);
  const auto commands = bridge.received.commands.all();
  ASSERT_EQ(commands.size(), 2u);
  const Command &first = commands[0].second, &second = commands[1].second;
  EXPECT_EQ(first.requester, second.requester);
  EXPECT_NE(first.request_id, second.request_id) << "bridges remember the first one";
  EXPECT_LE(second.expires, first.expires);
}

TEST(DdsCommand, ThatNobodyWaitsForIsSentAgainToo) {
  const std::string bus = bus_name("released");
  Obedient bridge(bus);
  bridge.received.answer = [&](const std::string& name, const Command& command) {
    const bool first = bridge.received.commands.size() == 1;
    bridge.link.complete(name, first ? refused_as(command, Cause::kShutdown) : done(command),
                         both_clocks());
  };
  Collected<StationResult> results;
  Station station(loopback(), "operator");
  station.on_result([&](const StationResult& result) { results.add(result); });
  StationCommand command = write_running(bus);
  command.person = "anna";
  command.command.request_id = station.reserve_request_id();
  const auto sent = station.send(command);
  ASSERT_TRUE(sent) << to_text(sent.error());
  ASSERT_TRUE(eventually([&] { return results.size() > 0; }));
  const StationResult result = results.all().front();
  EXPECT_EQ(result.state, CommandState::kDone);
  EXPECT_EQ(result.request_id, *sent) << "the caller sees one command";
  EXPECT_EQ(result.requester, station.requester() + "/anna");
  EXPECT_EQ(bridge.received.commands.size(), 2u);
  EXPECT_EQ(results.size(), 1u) << "and one result";
}

TEST(DdsCommand, ThatIsSentAgainWaitsForTheNextBridge) {
  const std::string bus = bus_name("handover");
  auto released = std::make_unique<Obedient>(bus);
  released->received.answer = [&](const std::string& name, const Command& command) {
    released->link.complete(name, refused_as(command, Cause::kShutdown), both_clocks());
  };
  Collected<StationResult> results;
  Station station(loopback(), "operator");
  station.on_result([&](const StationResult& result) { results.add(result); });
  ASSERT_TRUE(station.send(write_running(bus)));
  ASSERT_TRUE(eventually([&] { return released->received.commands.size() > 0; }));
  released.reset();
  Obedient successor(bus);
  ASSERT_TRUE(eventually([&] { return results.size() == 1; }));
  EXPECT_EQ(results.all().front().state, CommandState::kDone);
  EXPECT_EQ(successor.received.commands.size(), 1u);
}

TEST(DdsCommand, IsNotSentAgainWhenItMayHaveRunOrIsRefusedForAnotherReason) {
  const std::string bus = bus_name("once");
  Obedient bridge(bus);
  Station station(loopback(), "operator");
  CommandResult refusal = refused_as({}, Cause::kOffline);  // the store is not available
  bridge.received.answer = [&](const std::string& name, const Command& command) {
    refusal.requester = command.requester;
    refusal.request_id = command.request_id;
    bridge.link.complete(name, refusal, both_clocks());
  };
  ASSERT_TRUE(station.execute(write_running(bus)));
  refusal.state = CommandState::kFailed;  // it was started
  refusal.cause = Cause::kShutdown;
  const auto failed = station.execute(write_running(bus));
  ASSERT_TRUE(failed);
  EXPECT_EQ(failed->state, CommandState::kFailed);
  EXPECT_EQ(bridge.received.commands.size(), 2u) << "each once";
}

TEST(DdsCommand, IsSentAFewTimesOnlyToABridgeThatAlwaysStops) {
  const std::string bus = bus_name("stops");
  Obedient bridge(bus);
  bridge.received.answer = [&](const std::string& name, const Command& command) {
    bridge.link.complete(name, refused_as(command, Cause::kShutdown), both_clocks());
  };
  Station station(loopback(), "operator");
  const auto result = station.execute(write_running(bus));
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_TRUE(was_not_run(*result));
  EXPECT_LE(bridge.received.commands.size(), 6u);
  EXPECT_GE(bridge.received.commands.size(), 2u);
}

TEST(DdsCommand, IsNotKeptBackByAForgedClaimOnItsBus) {
  const std::string bus = bus_name("claimed");
  Obedient bridge(bus);
  Domain forger(loopback(), "forger", nullptr);
  dds::DataWriter* const claims = forger.writer(kBridgeTopic, "forger");
  idl::Bridge claim;
  to_idl(BridgeClaims{"forger", "host", "", UtcTime{1}, {{bus, {UtcTime{1}, true}}}}, claim);
  ASSERT_TRUE(is_taken(claims->write(&claim)));
  Collected<StationBridge> heard;
  Station station(loopback(), "operator");
  station.subscribe_bridges([&](const StationBridge& each) { heard.add(each); });
  ASSERT_TRUE(eventually([&] { return heard.size() >= 2; }));
  const auto result = station.execute(write_running(bus), 20s);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kDone);
}

TEST(DdsCommand, OfAClockThatIsBehindIsRefusedWithBothClocks) {
  const std::string bus = bus_name("behind");
  Received received;
  Collected<std::string> late;
  auto handlers = received.handlers();
  std::atomic<Duration> lived{};  // of the link, to detect commands written before it listened
  handlers.clock = [&lived] {
    UtcMapping now = both_clocks();
    now.instant += lived.load();
    now.utc.nanoseconds += Duration{10s}.count();  // the station is 10 s behind
    return now;
  };
  Collected<std::string> rejected;
  handlers.on_rejected = [&](const std::string& name, const Command& asked, const auto& result) {
    rejected.add(name + '/' + asked.device + ' ' + asked.requester + ": " + result.reason);
  };
  std::unique_ptr<DdsLink> link;
  handlers.on_command = [&](const std::string& name, const Command& command, std::string why) {
    if (why.empty()) return late.add("it came in time");
    CommandResult result = refused_as(command, Cause::kExpired);
    result.state = CommandState::kExpired;
    result.reason = std::move(why);
    link->complete(name, result, both_clocks());
  };
  link = std::make_unique<DdsLink>(loopback(), "test", std::move(handlers));
  link->add_bus(bus_of(bus, 1));
  claim(*link, {bus});
  Station station(loopback(), "operator");
  const std::string both = "by this bridge's clock: the requester's clock is 10.0 s behind";
  const auto early = station.execute(write_running(bus));
  ASSERT_TRUE(early) << to_text(early.error());
  EXPECT_EQ(early->state, CommandState::kRejected);
  EXPECT_THAT(early->reason, ::testing::HasSubstr("before this bridge began to listen"));
  EXPECT_THAT(early->reason, ::testing::HasSubstr(both));
  EXPECT_EQ(rejected.all(), std::vector{bus + "/d " + station.requester() + ": " + early->reason});
  lived = 1h;
  const auto result = station.execute(write_running(bus));
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kExpired);
  EXPECT_EQ(result->cause, to_name(Cause::kExpired));
  EXPECT_THAT(result->reason, ::testing::StartsWith("expired before it could run: written at "));
  EXPECT_THAT(result->reason, ::testing::HasSubstr(both));
  EXPECT_EQ(late.size(), 0u);
}

TEST(DdsCommand, ManyRequestersEachGetTheirOwnResults) {
  const std::string bus = bus_name("many");
  Obedient bridge(bus);
  std::vector<std::thread> threads;
  std::atomic<int> right{0};
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      Station station(loopback(), "operator-" + std::to_string(t));
      for (int i = 0; i < 50; ++i) {
        StationCommand command = write_running(bus);
        command.command.values = {std::int64_t{t * 1000 + i}};
        const auto result = station.execute(command);
        right += result && result->values == command.command.values;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(right, 150);
  EXPECT_EQ(bridge.received.commands.size(), 150u);
  EXPECT_THAT(bridge.received.problems.all(), ::testing::IsEmpty());
}

// Twice the limit of any endpoint: the second half fails unless instances are released.
TEST(DdsCommand, InstancesAreReleased) {
  constexpr std::uint64_t kCommands = 10'000;
  const std::string bus = bus_name("flood");
  Obedient bridge(bus);
  std::atomic<std::uint64_t> results{0};
  Station station(loopback(), "operator");
  station.on_result([&](const StationResult&) { ++results; });
  for (std::uint64_t i = 0; i < kCommands; ++i) {
    ASSERT_TRUE(station.send(write_running(bus))) << "command " << i;
    if (i % 256 != 255) continue;
    ASSERT_TRUE(eventually([&] { return results >= i - 255; }))
        << results << " results of " << i << ", " << bridge.received.commands.size() << " received";
  }
  EXPECT_TRUE(eventually([&] { return results == kCommands; })) << results << " results";
  EXPECT_THAT(bridge.received.problems.all(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace fieldcast::testing

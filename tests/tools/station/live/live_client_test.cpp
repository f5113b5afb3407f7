#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/station/live/live_client_support.hpp"
#include "tools/station/live/live_hub.hpp"

namespace fieldcast::web {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

struct LiveClientTest : ::testing::Test {
  FakeDomain domain;
  LivePerson anna{domain, "anna", Role::kOperator};
};

TEST_F(LiveClientTest, IsGreetedOnce) {
  EXPECT_THAT(anna.texts(),
              ElementsAre(R"({"kind":"hello","version":"1.2.3","user":"anna","role":"operator",)"
                          R"("now_ms":7,"catalogue":100})"));
  EXPECT_THAT(anna.frames(), IsEmpty());
}

TEST_F(LiveClientTest, IsNotifiedOfWhatExistsWithoutARequest) {
  domain.model.put(bus_of("shop"));
  LivePerson ben{domain, "ben", Role::kViewer};
  EXPECT_THAT(ben.texts(),
              ElementsAre(HasSubstr("hello"), HasSubstr(R"({"kind":"bus","bus":"shop")")));
  ASSERT_THAT(ben.frames(), SizeIs(1)) << "an empty frame behind texts tells when they are taken";
}

TEST_F(LiveClientTest, GetsNoValueBeforeItSubscribes) {
  domain.announce("oil");
  domain.publish("oil", 1.0);
  anna.settle();
  for (const auto& frame : anna.frames()) EXPECT_EQ(channels_in(*frame), 0u);
}

TEST_F(LiveClientTest, ASubscriptionBringsTheNewestValuesImmediately) {
  domain.announce("oil");
  domain.publish("oil", 1.0);
  anna.settle();
  anna.frames();
  anna.say(R"({"subscribe": "*"})");
  const auto frames = anna.frames();
  ASSERT_THAT(frames, SizeIs(1));
  EXPECT_EQ(channels_in(*frames[0]), 1u);
}

TEST_F(LiveClientTest, OnlyWhatMatchesComes) {
  for (const char* name : {"oil", "oil-2", "rpm"}) {
    domain.announce(name);
    domain.publish(name, 1.0);
  }
  anna.settle();
  anna.frames();
  anna.say(R"({"subscribe": "shop/*/oil*"})");
  EXPECT_EQ(channels_in(*anna.frames().at(0)), 2u);
  anna.settle();
  domain.publish("rpm", 2.0);
  anna.settle();
  EXPECT_THAT(anna.frames(), IsEmpty());
  domain.publish("oil", 2.0);
  anna.settle();
  EXPECT_EQ(channels_in(*anna.frames().at(0)), 1u);
}

TEST_F(LiveClientTest, OneFrameIsPendingAndTheNewestValueWins) {
  domain.announce("oil");
  domain.publish("oil", 1.0);
  anna.settle();
  anna.say(R"({"subscribe": "*"})");
  anna.frames();
  ASSERT_TRUE(anna.peer.under_way);
  for (int i = 0; i < 1000; ++i) {
    domain.publish("oil", 2.0 + i);
    anna.wait(milliseconds{20});
  }
  EXPECT_THAT(anna.frames(), IsEmpty());
  anna.take();
  const auto frames = anna.frames();
  ASSERT_THAT(frames, SizeIs(1));
  double value = 0;
  std::memcpy(&value, frames[0]->data() + kFrameHeader, sizeof value);
  EXPECT_EQ(value, 1001.0);
  EXPECT_THAT(anna.texts(), Contains(HasSubstr(R"({"kind":"lag","dropped_frames":)")));
}

TEST_F(LiveClientTest, FramesAreTwentyMillisecondsApart) {
  domain.announce("oil");
  anna.say(R"({"subscribe": "*"})");
  anna.settle();
  anna.frames();
  for (int ms = 0; ms < 200; ++ms) {
    domain.publish("oil", 1.0 * ms);
    anna.wait(milliseconds{1});
    if (anna.peer.under_way) anna.take();
  }
  EXPECT_THAT(anna.frames(), SizeIs(::testing::AllOf(::testing::Ge(9u), ::testing::Le(10u))));
}

TEST_F(LiveClientTest, WhatChangesTogetherAfterAPauseComesTogetherAndSoon) {
  domain.announce("oil");
  domain.announce("rpm");
  anna.say(R"({"subscribe": "*"})");
  anna.settle();
  anna.frames();
  anna.wait(seconds{1});
  domain.publish("oil", 1.0);
  anna.wait(milliseconds{2});
  domain.publish("rpm", 1.0);
  anna.wait(milliseconds{1});
  const auto frames = anna.frames();
  ASSERT_THAT(frames, SizeIs(1));
  EXPECT_EQ(channels_in(*frames[0]), 2u);
}

TEST_F(LiveClientTest, ClientsThatWantTheSameShareTheBytes) {
  LivePerson ben{domain, "ben", Role::kViewer};
  domain.announce("oil");
  domain.publish("oil", 1.0);
  anna.settle();
  ben.settle();
  anna.frames();
  ben.frames();
  anna.say(R"({"subscribe": "*"})");
  ben.say(R"({"subscribe": "*/*/*"})");
  EXPECT_EQ(anna.frames().at(0), ben.frames().at(0));
}

TEST_F(LiveClientTest, TextValuesComeAsTexts) {
  domain.announce("name", "string(16)");
  domain.publish("name", std::string("M7"));
  anna.settle();
  anna.texts();
  anna.say(R"({"subscribe": "*"})");
  EXPECT_THAT(anna.texts(), ElementsAre(HasSubstr(R"("value":["M7"])")));
}

TEST_F(LiveClientTest, WhenABridgeVanishesItsValuesAreUncertainImmediately) {
  domain.announce("oil");
  domain.publish("oil", 1.0);
  anna.say(R"({"subscribe": "*"})");
  anna.settle();
  anna.frames();
  anna.wait(seconds{1});
  domain.model.on_gone(path_of("oil"));
  domain.hub.on_news(domain.now);
  anna.wait(LiveClient::kGathering);
  const auto frames = anna.frames();
  ASSERT_THAT(frames, SizeIs(1));
  EXPECT_EQ(frames[0]->back(), 1) << "UNCERTAIN";
  EXPECT_THAT(anna.texts(), Contains(HasSubstr(R"({"kind":"catalogue","version":102})")));
}

TEST_F(LiveClientTest, NotesOfTheCatalogueAreRare) {
  anna.settle();
  anna.texts();
  for (int i = 0; i < 1000; ++i) {
    domain.announce("channel-" + std::to_string(i));
    domain.hub.on_news(domain.now);
    anna.wait(milliseconds{1});
    if (anna.peer.under_way) anna.take();
  }
  anna.wait(seconds{1});
  const auto texts = anna.texts();
  EXPECT_THAT(texts, SizeIs(::testing::Le(6u)));
  EXPECT_EQ(texts.back(), R"({"kind":"catalogue","version":1100})");
}

TEST_F(LiveClientTest, UnsubscribedChannelsComeNoMore) {
  domain.announce("oil");
  anna.say(R"({"subscribe": "*"})");
  anna.settle();
  anna.say(R"({"unsubscribe": "*"})");
  anna.frames();
  anna.texts();
  domain.publish("oil", 1.0);
  anna.settle();
  EXPECT_THAT(anna.frames(), IsEmpty());
  anna.say(R"({"unsubscribe": "*"})");
  EXPECT_THAT(anna.texts(), ElementsAre(HasSubstr("there is no such subscription")));
}

TEST_F(LiveClientTest, InterestsAreCountedAndTheShortestRefreshIsDeclared) {
  LivePerson ben{domain, "ben", Role::kViewer};
  anna.say(R"({"subscribe": "shop/press/oil", "refresh_ms": 500})");
  ben.say(R"({"subscribe": "shop/press/oil", "refresh_ms": 200})");
  EXPECT_THAT(domain.declared, ElementsAre(Pair("shop/press/oil", milliseconds{500}),
                                           Pair("shop/press/oil", milliseconds{200})));
  domain.declared.clear();
  ben.say(R"({"unsubscribe": "shop/press/oil"})");
  EXPECT_THAT(domain.declared, ElementsAre(Pair("shop/press/oil", milliseconds{500})));
  domain.declared.clear();
  anna.client->on_closed();
  EXPECT_THAT(domain.declared, ElementsAre(Pair("shop/press/oil", Duration{})));
  EXPECT_EQ(domain.interests.count(), 0u);
}

TEST_F(LiveClientTest, AnotherRefreshTakesThePlaceOfTheFirst) {
  anna.say(R"({"subscribe": "shop/press/oil", "refresh_ms": 500})");
  anna.say(R"({"subscribe": "shop/press/oil", "refresh_ms": 900})");
  EXPECT_THAT(domain.declared, ElementsAre(Pair("shop/press/oil", milliseconds{500}),
                                           Pair("shop/press/oil", milliseconds{900})));
}

TEST_F(LiveClientTest, AnInterestIsForOneDevice) {
  anna.texts();
  anna.say(R"({"subscribe": "*", "refresh_ms": 500, "id": 4})");
  EXPECT_THAT(anna.texts(), ElementsAre(AllOf(HasSubstr(R"("refused","id":4)"),
                                              HasSubstr("for the channels of one device"))));
  EXPECT_THAT(domain.declared, IsEmpty());
}

TEST_F(LiveClientTest, AWriteGoesOutAndItsResultComesBack) {
  domain.announce("oil");
  anna.settle();
  anna.texts();
  anna.say(R"({"write": {"channel": "shop/press/oil", "value": 21.5, "verify": true}, "id": 7})");
  ASSERT_THAT(domain.commands.asked, SizeIs(1));
  const auto& asked = domain.commands.asked[0];
  EXPECT_EQ(asked.caller.user, "anna");
  EXPECT_EQ(asked.command.command.values, std::vector<Value>{21.5});
  EXPECT_TRUE(asked.command.command.verify);
  EXPECT_THAT(anna.texts(), IsEmpty());
  asked.done({.request_id = 1,
              .user = "anna",
              .target = "shop/press/oil",
              .state = "verified",
              .cause = "NONE",
              .values = {21.5},
              .completed_at = {3'000'000}});
  EXPECT_THAT(anna.texts(),
              ElementsAre(R"({"kind":"result","id":7,"request_id":1,"target":"shop/press/oil",)"
                          R"("state":"verified","cause":"NONE","reason":"","value":21.5,)"
                          R"("completed_ms":3})"));
}

TEST_F(LiveClientTest, AResultForAClosedClientIsDropped) {
  domain.announce("oil");
  anna.say(R"({"acquire": {"channel": "shop/press/oil"}})");
  anna.client->on_closed();
  anna.client.reset();
  ASSERT_THAT(domain.commands.asked, SizeIs(1));
  EXPECT_EQ(domain.commands.asked[0].command.command.operation, Operation::kAcquire);
  domain.commands.asked[0].done({});
}

TEST_F(LiveClientTest, AViewerMayNotCommand) {
  domain.announce("oil");
  LivePerson ben{domain, "ben", Role::kViewer};
  ben.texts();
  ben.say(R"({"write": {"channel": "shop/press/oil", "value": 1}, "id": 1})");
  ben.say(R"({"acquire": {"channel": "shop/press/oil"}, "id": 2})");
  EXPECT_THAT(ben.texts(),
              ElementsAre(HasSubstr("your role is viewer"), HasSubstr("your role is viewer")));
  EXPECT_THAT(domain.commands.asked, IsEmpty());
}

TEST_F(LiveClientTest, WhatCannotBeSentIsRefusedWithAReason) {
  domain.announce("oil");
  domain.announce("name", "string(8)");
  anna.settle();
  anna.texts();
  anna.say(R"({"write": {"channel": "shop/press/rpm", "value": 1}, "id": 1})");
  anna.say(R"({"write": {"channel": "shop/press/oil", "value": "abc"}, "id": 2})");
  anna.say(R"({"write": {"channel": "shop/press/name", "value": 5}, "id": 3})");
  domain.commands.full = true;
  anna.say(R"({"write": {"channel": "shop/press/oil", "value": 1}, "id": 4})");
  EXPECT_THAT(anna.texts(),
              ElementsAre(AllOf(HasSubstr(R"("id":1)"), HasSubstr("rpm is unknown")),
                          AllOf(HasSubstr(R"("id":2)"), HasSubstr("'abc' is no such value")),
                          AllOf(HasSubstr(R"("id":3)"), HasSubstr("this is no text")),
                          AllOf(HasSubstr(R"("id":4)"), HasSubstr("too many commands wait"))));
}

TEST_F(LiveClientTest, AResultOfARequestByHttpIsReportedToItsUser) {
  LivePerson ben{domain, "ben", Role::kOperator};
  anna.texts();
  ben.texts();
  domain.hub.on_outcome({.request_id = 9, .user = "anna", .state = "done"});
  EXPECT_THAT(anna.texts(), ElementsAre(HasSubstr(R"({"kind":"result","request_id":9)")));
  EXPECT_THAT(ben.texts(), IsEmpty());
}

TEST_F(LiveClientTest, APingGetsAResponse) {
  anna.texts();
  anna.say(R"({"ping": 5})");
  EXPECT_THAT(anna.texts(), ElementsAre(R"({"kind":"pong","id":5,"now_ms":7})"));
}

TEST_F(LiveClientTest, TwentyMessagesASecondAndNoMore) {
  anna.texts();
  for (int i = 0; i < 21; ++i) anna.say(R"({"ping": 5})");
  EXPECT_THAT(anna.texts().back(), HasSubstr("too many messages"));
  anna.wait(milliseconds{50});
  anna.say(R"({"ping": 6})");
  EXPECT_THAT(anna.texts(), ElementsAre(R"({"kind":"pong","id":6,"now_ms":7})"));
}

TEST_F(LiveClientTest, AFloodEndsTheConnection) {
  anna.say(R"({"subscribe": "shop/press/oil", "refresh_ms": 500})");
  for (int i = 0; i < 100; ++i) anna.say("x");
  EXPECT_EQ(anna.peer.closed, "too many messages");
  EXPECT_EQ(domain.interests.count(), 0u);
}

TEST_F(LiveClientTest, SixteenSubscriptionsAndNoMore) {
  for (int i = 0; i < 16; ++i) {
    anna.say(R"({"subscribe": "bus-)" + std::to_string(i) + R"("})");
    anna.wait(milliseconds{100});
  }
  anna.texts();
  anna.say(R"({"subscribe": "hall"})");
  EXPECT_THAT(anna.texts(), ElementsAre(HasSubstr("too many subscriptions")));
  anna.say(R"({"subscribe": "bus-3"})");
  EXPECT_THAT(anna.texts(), IsEmpty()) << "it is one of them";
}

TEST_F(LiveClientTest, AClientThatMissedTooMuchIsClosed) {
  domain.model.put(bus_of("shop"));
  domain.hub.on_news(domain.now);
  anna.wait(LiveClient::kGathering);
  for (std::size_t i = 0; i <= LiveObjects::kMaxGone; ++i) {
    domain.model.put(bus_of("bus-" + std::to_string(i)));
    domain.model.remove(bus_of("bus-" + std::to_string(i)));
  }
  anna.wait(seconds{1});
  anna.take();
  EXPECT_EQ(anna.peer.closed, "too far behind");
}

}  // namespace
}  // namespace fieldcast::web

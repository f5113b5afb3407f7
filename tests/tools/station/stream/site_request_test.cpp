#include "tools/station/stream/site_request.hpp"

#include <gtest/gtest.h>

#include "tools/station/live/client_message.hpp"

namespace fieldcast::web {
namespace {

constexpr UtcTime kMoment{1'764'360'000'000'000'000};

forward::CommandRequest read(const SiteRequest& request) {
  const auto found =
      forward::command_request_from(request.text, "anna", {{"*", {Pattern()}}}, kMoment);
  EXPECT_TRUE(found) << found.error().reason;
  return found.value_or(forward::CommandRequest{});
}

TEST(SiteRequest, NamesSiteUserAndChannel) {
  StationCommand command = write_command({"north.1:line", "press", "oil"}, Value{21.5}, true);
  command.person = "anna";
  const auto request = site_request_of(command, "7-1", kMoment);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->subject, "fieldcast-command.north=2E1.anna");
  const forward::CommandRequest found = read(*request);
  EXPECT_EQ(found.id, "7-1");
  EXPECT_EQ(found.channel.text(), "line/press/oil");
  EXPECT_EQ(found.value, Value{21.5});
  EXPECT_TRUE(found.verify);
  EXPECT_EQ(found.expires_at.nanoseconds, kMoment.nanoseconds + command.lifespan.count());
  command = acquire_command({"north:line", "press", "oil"});
  EXPECT_EQ(read(*site_request_of(command, "7-2", kMoment)).action,
            forward::CentreAction::kAcquire);
  EXPECT_FALSE(site_request_of(acquire_command({"line", "press", "oil"}), "7-3", kMoment));
}

TEST(SiteRequest, HasTheActionsOnAlarmsOnly) {
  AlarmAction action{.kind = AlarmActionKind::kShelve,
                     .alarm = {"north:line", "press", "oil", LimitKind::kLow},
                     .by = "anna",
                     .note = "fan",
                     .duration = std::chrono::minutes{30}};
  const auto request = site_request_of(action, "7-1", kMoment);
  ASSERT_TRUE(request);
  const forward::CommandRequest found = read(*request);
  EXPECT_EQ(found.action, forward::CentreAction::kShelve);
  EXPECT_EQ(found.limit, LimitKind::kLow);
  EXPECT_EQ(found.note, "fan");
  EXPECT_EQ(found.minutes, 30u);
  EXPECT_EQ(found.raised_at, UtcTime{});
  action.kind = AlarmActionKind::kAcknowledge;
  action.raised_at = {1'764'360'000'123'456'789};
  EXPECT_EQ(read(*site_request_of(action, "7-2", kMoment)).raised_at, action.raised_at);
  action.kind = AlarmActionKind::kEndSession;
  EXPECT_FALSE(site_request_of(action, "7-1", kMoment));
}

TEST(SiteOutcome, IsThatOfTheSite) {
  const auto outcome = site_outcome_from(
      to_json(forward::CommandResponse{
          .id = "7-1", .state = "rejected", .cause = "NONE", .reason = "user 'anna' has no right"}),
      5);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->request_id, 5u);
  EXPECT_EQ(outcome->state, CommandState::kRejected);
  EXPECT_EQ(outcome->reason, "user 'anna' has no right");
}

TEST(SiteOutcome, IsUnknownIfTheSiteDoesNotKnowIt) {
  const forward::CommandResponse unknown{.state = "unknown", .cause = "NONE"};
  for (const std::string& text : {to_json(unknown), std::string("poison")}) {
    const auto outcome = site_outcome_from(text, 5);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error(), StationFault::kNoResult);
  }
}

}  // namespace
}  // namespace fieldcast::web

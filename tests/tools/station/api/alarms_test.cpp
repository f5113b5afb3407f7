#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::utc;
using AlarmsApiTest = test::ApiTest;

TEST_F(AlarmsApiTest, ThePresentComesFromTheModel) {
  LiveModel model;
  LiveAlarm alarm;
  alarm.bus = "line";
  alarm.state = "unacknowledged";
  alarm.active = true;
  model.put(alarm);
  add_routes(table_, {.model = &model, .now = now()});
  EXPECT_EQ(json("/api/alarms").at("alarms").at(0).at("bus"), "line");
  EXPECT_EQ(ask("/api/alarms?from=1h").status, 404u) << "there is no store";
  EXPECT_EQ(ask("/api/alarms?form=1h").status, 400u);
}

TEST_F(AlarmsApiTest, TheHistoryTellsTheNewestFirstAndNothingTwice) {
  const AlarmRecord raised{"line", "press", "level", "high", "active", 101, utc(kNow - 20)};
  const AlarmEvent seen{.at = utc(kNow - 10),
                        .alarm = {"line", "press", "level", LimitKind::kHigh},
                        .kind = AlarmEventKind::kAcknowledged,
                        .by = "anna",
                        .note = "seen"};
  store([&](Store& to) {
    for (int i = 0; i < 2; ++i) {
      to.put(raised);
      to.put(seen);
    }
  });
  const LiveModel model;
  add_routes(table_, {.model = &model, .database = database(), .now = now()});
  const auto events = json("/api/alarms?from=1h").at("events");
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].at("event"), "acknowledged");
  EXPECT_EQ(events[0].at("who"), "anna");
  EXPECT_TRUE(events[0].at("value").is_null());
  EXPECT_EQ(events[1].at("event"), "raised");
  EXPECT_EQ(events[1].at("value"), 101);
  EXPECT_EQ(json("/api/alarms?from=1h&limit=1").at("events").size(), 1u);
}

}  // namespace
}  // namespace fieldcast::web

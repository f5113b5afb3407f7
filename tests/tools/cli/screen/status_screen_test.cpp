#include "tools/cli/screen/status_screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/cli/screen/screen_text.hpp"

namespace fieldcast::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class StatusScreenTest : public testing::Test {
 protected:
  StatusScreenTest() {
    for (const char* name : {"a-line", "press"}) {
      StationBusStatus bus{"line-7", name, {}, {}, at_.utc};
      bus.report.state = BusState::kRunning;
      bus.report.utilisation = 0.731;
      model_.buses[name] = bus;
    }
    add("a-line", "meter", DeviceState::kOnline, {});
    add("press", "p1", DeviceState::kOnline, {});
    add("press", "p2", DeviceState::kOffline, {{"NO_ANSWER", 6}, {"CHECKSUM", 1}});
  }
  void add(const std::string& bus, const std::string& device, DeviceState state,
           const CauseCounts& causes) {
    StationDeviceStatus status{bus, device, {}, causes, at_.utc};
    status.report.state = state;
    status.report.exchanges = 400;
    model_.devices[{bus, device}] = status;
  }
  void stand_by(const std::string& bridge, StandbyRole role, const std::string& not_ready) {
    StandbyMessage message;
    message.group = "line-7";
    message.member.bridge = bridge;
    message.member.role = role;
    message.member.not_ready = not_ready;
    const bool master = role == StandbyRole::kMaster;
    message.buses = {{.bus = "press", .epoch = 1, .blocks = master ? 112u : 100u}};
    model_.members[{"line-7", bridge}] = message;
  }
  std::string draw(std::size_t columns = 80, std::size_t rows = 24) {
    return next_frame(screen_, at_, {columns, rows, false});
  }
  bool press(const Key& key) { return screen_.on_key(key, at_); }

  Moment at_{Instant{}, UtcTime{1'700'000'000'000'000'000}};
  StatusModel model_;
  StatusScreen screen_{model_};
};

TEST_F(StatusScreenTest, BadOnesComeFirst) {
  const std::string text = draw();
  EXPECT_THAT(text, HasSubstr("2/3 online  2 of 2 buses running"));
  EXPECT_LT(text.find("- press"), text.find("- a-line"));
  EXPECT_LT(text.find("p2"), text.find("p1"));
  EXPECT_THAT(text, HasSubstr("wire 73.1 %"));
}

TEST_F(StatusScreenTest, TheDetailsSayWhyADeviceIsOffline) {
  draw();
  EXPECT_TRUE(press({Key::Kind::kDown}));
  const std::string text = draw(100);
  EXPECT_THAT(text, AllOf(HasSubstr("press/p2"), HasSubstr("offline: no response 6 times"),
                          HasSubstr("look at its power, its cable")));
}

TEST_F(StatusScreenTest, FilterSortBadOnlyAndQuit) {
  draw();
  for (const char* letter : {"/", "o", "f", "f", "l"}) EXPECT_TRUE(press(text_key(letter)));
  EXPECT_THAT(draw(), AllOf(HasSubstr("p2"), Not(HasSubstr("p1")), Not(HasSubstr("a-line"))));
  EXPECT_TRUE(press({Key::Kind::kEscape}));
  EXPECT_TRUE(press(text_key("s")));
  const std::string text = draw();
  EXPECT_LT(text.find("- a-line"), text.find("- press"));
  EXPECT_TRUE(press(text_key("b")));
  EXPECT_THAT(draw(), AllOf(HasSubstr("p2"), Not(HasSubstr("meter"))));
  EXPECT_TRUE(press(function_key(1)));
  EXPECT_THAT(draw(), HasSubstr("gap: unused addresses between two channels"));
  EXPECT_TRUE(press({Key::Kind::kEscape}));
  EXPECT_FALSE(press(text_key("q")));
}

TEST_F(StatusScreenTest, AStandbyGroupHasARowAndItsMembersSayWhatTheyAre) {
  stand_by("line-7-a", StandbyRole::kMaster, {});
  stand_by("line-7-b", StandbyRole::kWaiting, {});
  std::string text = draw(100);
  EXPECT_THAT(text, AllOf(HasSubstr("1 of 1 groups served"), HasSubstr("- group line-7"),
                          HasSubstr("master"), HasSubstr("12 behind")));
  stand_by("line-7-b", StandbyRole::kWaiting, "its channels differ from those of line-7-a");
  draw(100);
  for (const char* letter : {"/", "n", "o", "t"}) EXPECT_TRUE(press(text_key(letter)));
  EXPECT_TRUE(press({Key::Kind::kEnter}));
  draw(100);
  EXPECT_TRUE(press({Key::Kind::kDown}));
  text = draw(100);
  EXPECT_THAT(text, AllOf(HasSubstr("not ready"), HasSubstr("line-7-b"), Not(HasSubstr("press"))));
  EXPECT_THAT(text, HasSubstr("does not take over: its channels differ from those of line-7-a"));
}

TEST_F(StatusScreenTest, AGroupWithoutAMasterStandsFirst) {
  stand_by("line-7-b", StandbyRole::kWaiting, "it follows no master yet");
  const std::string text = draw(100);
  EXPECT_THAT(text, AllOf(HasSubstr("0 of 1 groups served"), HasSubstr("no master"),
                          HasSubstr("nobody serves the buses of the group")));
  EXPECT_LT(text.find("group line-7"), text.find("press"));
}

TEST_F(StatusScreenTest, EverySizeIsDrawnWhole) {
  stand_by("line-7-a", StandbyRole::kMaster, {});
  stand_by("line-7-b", StandbyRole::kWaiting, "its clock is far away");
  for (std::size_t rows = 1; rows < 30; ++rows) {
    for (const std::size_t columns : {1, 5, 20, 40, 60, 79, 80, 120, 300}) draw(columns, rows);
  }
  EXPECT_THAT(draw(20, 12), AllOf(HasSubstr("p2"), HasSubstr("offline")));
}

TEST_F(StatusScreenTest, WithoutABridgeTheNoticeIsShown) {
  model_ = {};
  screen_.set_notice("waiting for a bridge");
  EXPECT_THAT(draw(), HasSubstr("waiting for a bridge"));
}

}  // namespace
}  // namespace fieldcast::cli

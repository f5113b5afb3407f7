#include "tools/cli/screen/watch_screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/cli/screen/screen_text.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class WatchScreenTest : public testing::Test {
 protected:
  WatchScreenTest() {
    add("press", "p1", "pressure", 12.5, Quality::kGood);
    add("press", "p1", "setpoint", 21.5, Quality::kGood, Access::kReadWrite);
    add("press", "p2", "count", 7.0, Quality::kBadNoResponse);
    add("a-line", "d", "level", 3.0, Quality::kGood);
  }

  void add(const std::string& bus, const std::string& device, const std::string& name, double value,
           Quality quality, Access access = Access::kReadOnly) {
    StationChannel about;
    about.bus = bus;
    about.device = device;
    about.channel = name;
    about.type = "float64";
    about.unit = "bar";
    about.at = "holding:1";
    about.access = access;
    about.refresh = 500ms;
    model_.on_channel(about);
    const StationSample sample{bus, device, name, value, quality, 0, at_.utc, 1};
    model_.on_sample(sample, at_.now);
    screen_.on_sample(sample);
  }

  std::string draw(std::size_t columns = 80, std::size_t rows = 24) {
    return next_frame(screen_, at_, {columns, rows, true});
  }
  Intent press(const Key& key) { return screen_.on_key(key, at_); }
  void type(const std::string& text) {
    for (const char c : text) (void)press(text_key({c}));
  }
  void select(const std::string& name) {
    type("/" + name);
    (void)press({Key::Kind::kEnter});
    draw();
    (void)press({Key::Kind::kEnd});
    draw();
  }

  Moment at_{Instant{}, UtcTime{1'700'000'000'000'000'000}};
  WatchModel model_{Pattern{}};
  StatusModel status_;
  WatchScreen screen_{model_, status_, true};
};

TEST_F(WatchScreenTest, BadOnesComeFirstInTheirGroups) {
  const std::string text = draw();
  EXPECT_THAT(text, HasSubstr("1 BAD  3 of 4 GOOD"));
  EXPECT_LT(text.find("- press  2 of 3 GOOD, 1 BAD"), text.find("- a-line  1 of 1 GOOD"));
  EXPECT_LT(text.find("- p2"), text.find("- p1"));
  EXPECT_THAT(text, HasSubstr("BAD_NO_ANSWER"));
}

TEST_F(WatchScreenTest, GroupsFoldAndUnfold) {
  draw();
  (void)press({Key::Kind::kEnter});
  EXPECT_THAT(draw(),
              AllOf(HasSubstr("+ press  2 of 3 GOOD"), Not(HasSubstr("- p1")), HasSubstr("level")));
  (void)press({Key::Kind::kRight});
  EXPECT_THAT(draw(), HasSubstr("- p1"));
  (void)press(text_key("t"));
  EXPECT_THAT(draw(), AllOf(HasSubstr("press/p1/pressure"), Not(HasSubstr("- press"))));
}

TEST_F(WatchScreenTest, FilterTakesWordsOfPathQualityAndUnit) {
  draw();
  type("/PRESS good");
  EXPECT_THAT(draw(), AllOf(HasSubstr("pressure"), HasSubstr("setpoint"), Not(HasSubstr("count")),
                            Not(HasSubstr("level")), HasSubstr("filter: PRESS good")));
  (void)press({Key::Kind::kClear});
  type("nothing");
  EXPECT_THAT(draw(), HasSubstr("nothing matches the filter"));
  (void)press({Key::Kind::kEscape});
  EXPECT_THAT(draw(), HasSubstr("level"));
}

TEST_F(WatchScreenTest, SortsByEachColumn) {
  (void)press(text_key("t"));
  (void)press(text_key("s"));  // by name
  std::string text = draw();
  EXPECT_LT(text.find("a-line/d/level"), text.find("press/p2/count"));
  (void)press(function_key(6));  // by value, descending
  text = draw();
  EXPECT_LT(text.find("setpoint"), text.find("pressure"));
  EXPECT_LT(text.find("count"), text.find("level"));
  (void)press(text_key("i"));
  text = draw();
  EXPECT_LT(text.find("level"), text.find("count"));
  (void)press({Key::Kind::kClick, {}, 0, 2, 3});  // header of the name column
  text = draw();
  EXPECT_THAT(text, HasSubstr("sort: name"));
}

TEST_F(WatchScreenTest, BadOnlyLeavesOutWhatIsGood) {
  (void)press(text_key("b"));
  EXPECT_THAT(draw(), AllOf(HasSubstr("count"), Not(HasSubstr("level"))));
}

TEST_F(WatchScreenTest, AWriteShowsOldAndNewValueAndWaitsForTheYes) {
  draw();
  select("setpoint");
  (void)press(text_key("w"));
  EXPECT_THAT(draw(), AllOf(HasSubstr("Write press/p1/setpoint"), HasSubstr("21.5 bar")));
  type("ab");
  (void)press({Key::Kind::kEnter});
  EXPECT_THAT(draw(), HasSubstr("'ab' is no number"));
  (void)press({Key::Kind::kClear});
  type("22");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(press({Key::Kind::kEnter})));
  EXPECT_THAT(draw(), AllOf(HasSubstr("value now   21.5 bar  (GOOD"),
                            HasSubstr("new value   22 bar"), HasSubstr("y: write it")));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(press({Key::Kind::kEnter})))
      << "Enter is no yes";
  const Intent intent = press(text_key("v"));
  ASSERT_TRUE(std::holds_alternative<WriteIntent>(intent));
  EXPECT_EQ(std::get<WriteIntent>(intent).path.text(), "press/p1/setpoint");
  EXPECT_EQ(std::get<WriteIntent>(intent).value, Value{22.0});
  EXPECT_TRUE(std::get<WriteIntent>(intent).verify);
  EXPECT_THAT(draw(), HasSubstr("writing press/p1/setpoint"));
  (void)press(text_key("w"));
  EXPECT_THAT(draw(), HasSubstr("the write before has no result yet"));
  Outcome outcome = refused_here({"press", "p1", "setpoint"}, true, Cause::kRange, "too much");
  screen_.on_outcome(outcome);
  EXPECT_THAT(draw(), HasSubstr("press/p1/setpoint: rejected: too much (RANGE)"));
  EXPECT_THAT(draw(24, 20), HasSubstr("(RANGE)")) << "a long message is wrapped";
}

TEST_F(WatchScreenTest, EscapeWritesNothing) {
  draw();
  select("setpoint");
  (void)press(text_key("w"));
  type("1");
  (void)press({Key::Kind::kEnter});
  EXPECT_TRUE(std::holds_alternative<std::monostate>(press(text_key("n"))));
  EXPECT_THAT(draw(), HasSubstr("nothing was written"));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(press(text_key("y"))));
}

TEST_F(WatchScreenTest, WhatIsReadOnlyOrAGroupIsNotWritten) {
  draw();
  (void)press(text_key("w"));
  EXPECT_THAT(draw(), HasSubstr("select a channel to write to"));
  select("level");
  (void)press(text_key("w"));
  EXPECT_THAT(draw(), HasSubstr("a-line/d/level is read-only"));
}

TEST_F(WatchScreenTest, DetailsSayWhatTheQualityMeansAndDrawTheTrend) {
  draw();
  select("count");
  EXPECT_THAT(draw(), HasSubstr("BAD_NO_ANSWER: the device, or the way to it, is silent"));
  (void)press({Key::Kind::kEscape});
  select("pressure");
  for (int i = 0; i < 8; ++i) {
    at_.utc.nanoseconds += 1'000'000'000;
    add("press", "p1", "pressure", i, Quality::kGood);
  }
  EXPECT_THAT(draw(), AllOf(HasSubstr("float64 at holding:1, read-only, refresh 500ms"),
                            HasSubstr("[█▁▁▂▂▃▄▄▅] 12.5")))
      << "the first value is the greatest";
}

TEST_F(WatchScreenTest, EverySizeIsDrawnWhole) {
  for (std::size_t rows = 1; rows < 30; ++rows) {
    for (const std::size_t columns : {1, 5, 20, 40, 60, 79, 80, 120, 300}) draw(columns, rows);
  }
  const std::string narrow = draw(20, 12);
  EXPECT_THAT(narrow, AllOf(HasSubstr("count"), HasSubstr("7 B"), HasSubstr("watch  1 BAD")));
  select("setpoint");
  (void)press(text_key("w"));
  for (std::size_t rows = 1; rows < 30; ++rows) draw(20, rows);
  EXPECT_THAT(draw(20, 10), AllOf(HasSubstr("21.5 bar"), HasSubstr("\nnew\n")));
}

TEST_F(WatchScreenTest, HelpScrollsAndAnyOtherKeyLeavesIt) {
  (void)press(function_key(1));
  EXPECT_THAT(draw(), AllOf(HasSubstr("write a value to the selected channel"),
                            HasSubstr("any other key: back")));
  for (int i = 0; i < 30; ++i) (void)press({Key::Kind::kPageDown});
  EXPECT_THAT(draw(), HasSubstr("GONE"));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(press(text_key("q"))));
  EXPECT_TRUE(std::holds_alternative<QuitIntent>(press(text_key("q"))));
}

TEST_F(WatchScreenTest, AClickSelectsAndASecondOneFolds) {
  draw();
  (void)press({Key::Kind::kClick, {}, 0, 4, 3});
  EXPECT_THAT(draw(), HasSubstr("press/p2")) << "the details of the device";
  (void)press({Key::Kind::kClick, {}, 0, 4, 3});
  EXPECT_THAT(draw(), HasSubstr("+ p2"));
  (void)press({Key::Kind::kClick, {}, 0, 23, 0});  // F1 in the bottom line
  EXPECT_THAT(draw(), HasSubstr("any other key: back"));
}

TEST_F(WatchScreenTest, NamesOfOthersStayInTheirCells) {
  add("press", "\x1b[31m\u202Eevil", "温度温度温度温度温度温度温度温度温度温度温度温度", 1.0,
      Quality::kBadFrame);
  EXPECT_THAT(draw(), AllOf(HasSubstr("\\x1B[31m\\u{202E}evil"), Not(HasSubstr("\x1b"))));
  for (const std::size_t columns : {20, 33, 47, 80}) draw(columns);
}

TEST_F(WatchScreenTest, AGroupSaysWhenItsBusOrDeviceIsNotWell) {
  StationBusStatus bus;
  bus.bus = "press";
  bus.report.state = BusState::kClosed;
  bus.report.closed_because = Cause::kPortMissing;
  status_.buses["press"] = bus;
  const std::string text = draw();
  EXPECT_THAT(text, HasSubstr("- press  2 of 3 GOOD, 1 BAD  closed"));
  EXPECT_THAT(text, HasSubstr("closed: no such device file; look whether the adapter"));
}

TEST(WatchScreen, TenThousandChannelsAreDrawnFast) {
  WatchModel model{Pattern{}};
  StatusModel status;
  for (int i = 0; i < 10'000; ++i) {
    const StationSample sample{"bus-" + std::to_string(i / 1000),
                               "d" + std::to_string(i / 50 % 20),
                               "channel-" + std::to_string(i),
                               1.0,
                               Quality::kGood,
                               0,
                               UtcTime{1'700'000'000'000'000'000},
                               1};
    model.on_sample(sample, Instant{});
  }
  WatchScreen screen(model, status, false);
  const Moment at{Instant{1s}, UtcTime{1'700'000'001'000'000'000}};
  const auto began = std::chrono::steady_clock::now();
  EXPECT_THAT(text_of(screen.frame(at, {80, 24, false})), HasSubstr("10000 of 10000 GOOD"));
  (void)screen.on_key({Key::Kind::kEnd}, at);
  EXPECT_THAT(text_of(screen.frame(at, {80, 24, false})), HasSubstr("channel-"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, 2s) << "generous: for sanitizers";
}

}  // namespace
}  // namespace fieldcast::cli

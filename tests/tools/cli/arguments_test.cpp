#include "tools/cli/arguments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tools/cli/command/line/acquire.hpp"
#include "tools/cli/command/plan.hpp"
#include "tools/cli/command/station/alarms.hpp"
#include "tools/cli/command/station/history.hpp"
#include "tools/cli/command/station/records.hpp"
#include "tools/cli/command/station/status.hpp"
#include "tools/cli/command/station/watch.hpp"
#include "tools/cli/command/station/write.hpp"
#include "tools/cli/command/user.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

using Parsed = tl::expected<std::unique_ptr<Command>, NoCommand>;

Parsed parse(std::vector<const char*> words) {
  words.insert(words.begin(), "fieldcast");
  return parse_arguments(static_cast<int>(words.size()), words.data());
}

template <typename Options>
const Options& options_of(const Parsed& parsed) {
  return dynamic_cast<const CommandWith<Options>&>(*parsed.value()).options();
}

TEST(Arguments, WatchTakesPatternAndTimes) {
  const auto parsed = parse({"watch", "press-shop/press-1", "--json", "--once", "--for", "500ms",
                             "--refresh", "1s", "--domain", "7"});
  const auto& watch = options_of<WatchOptions>(parsed);
  EXPECT_EQ(watch.pattern.text(), "press-shop/press-1/*");
  EXPECT_TRUE(watch.json);
  EXPECT_TRUE(watch.once);
  EXPECT_EQ(watch.time, Duration{500ms});
  EXPECT_EQ(watch.refresh, Duration{1s});
  EXPECT_EQ(watch.connection.domain, 7u);
}

TEST(Arguments, WriteTakesAssignmentsAndNegativeValues) {
  const auto assignments = parse({"write", "a/b/c=-1", "a/b/d=x y", "--verify"});
  EXPECT_THAT(options_of<WriteOptions>(assignments).words,
              testing::ElementsAre("a/b/c=-1", "a/b/d=x y"));
  const auto address = parse({"write", "a/b", "--at", "holding:100", "--type", "int16", "-5", "7"});
  EXPECT_THAT(options_of<WriteOptions>(address).words, testing::ElementsAre("a/b", "-5", "7"));
  EXPECT_EQ(options_of<WriteOptions>(address).at, "holding:100");
}

TEST(Arguments, AcquireTakesAnAddressWithCountAndType) {
  const auto parsed = parse({"acquire", "a/b", "--at", "holding:100", "--count", "4", "--type",
                             "float32", "--timeout", "2"});
  const auto& acquire = options_of<AcquireOptions>(parsed);
  EXPECT_EQ(acquire.count, 4u);
  EXPECT_EQ(acquire.type, "float32");
  EXPECT_EQ(acquire.timeout, Duration{2s});
}

TEST(Arguments, HistoryTakesAPatternAndATime) {
  const auto parsed = parse({"history", "a/b", "--from", "2026-11-21", "--to", "2026-11-22T10:00",
                             "--csv", "--store", "x.db"});
  const auto& history = options_of<HistoryOptions>(parsed);
  EXPECT_EQ(history.pattern.text(), "a/b/*");
  EXPECT_EQ(history.span.to.nanoseconds - history.span.from.nanoseconds, Duration(34h).count());
  EXPECT_TRUE(history.csv);
  EXPECT_EQ(history.source.store, "x.db");
}

TEST(Arguments, HistoryTakesAWidthOrANumberOfPoints) {
  const auto every = parse({"history", "a", "--every", "5min", "--local"});
  EXPECT_EQ(options_of<HistoryOptions>(every).every, Duration(5min));
  const auto points = parse({"history", "a", "--points", "1000"});
  EXPECT_EQ(options_of<HistoryOptions>(points).points, 1000u);
  for (const auto& words : {std::vector<const char*>{"--every", "1min", "--points", "9"},
                            {"--points", "1"},
                            {"--every", "0s"},
                            {"--every", "soon"}}) {
    std::vector<const char*> all{"history", "a"};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(parse(all).error().code, ExitCode::kUsage) << words[1];
  }
}

TEST(Arguments, TimesDefaultToTheLastHour) {
  const auto parsed = parse({"audit"});
  const auto& audit = options_of<AuditOptions>(parsed);
  EXPECT_EQ(audit.span.to.nanoseconds - audit.span.from.nanoseconds, Duration(1h).count());
  EXPECT_FALSE(options_of<AlarmsOptions>(parse({"alarms"})).span) << "now, from the bridges";
  EXPECT_TRUE(options_of<AlarmsOptions>(parse({"alarms", "--from", "2h"})).span);
}

TEST(Arguments, AlarmsAreShownOrActedUpon) {
  const auto shown = parse({"alarms", "--json"});
  EXPECT_FALSE(options_of<AlarmsOptions>(shown).action);
  const auto parsed =
      parse({"alarms", "ack", "a/b", "--limit", "high", "--note", "seen", "--domain", "7"});
  const auto& acknowledged = options_of<AlarmsOptions>(parsed);
  EXPECT_EQ(acknowledged.action, AlarmActionKind::kAcknowledge);
  EXPECT_EQ(acknowledged.pattern.text(), "a/b/*");
  EXPECT_EQ(acknowledged.limit, LimitKind::kHigh);
  EXPECT_EQ(acknowledged.note, "seen");
  EXPECT_EQ(acknowledged.connection.domain, 7u);
  const auto shelve = parse({"alarms", "shelve", "*", "--for", "30min"});
  EXPECT_EQ(options_of<AlarmsOptions>(shelve).action, AlarmActionKind::kShelve);
  EXPECT_EQ(options_of<AlarmsOptions>(shelve).duration, Duration(30min));
  const auto maintenance = parse({"alarms", "maintenance", "a/b", "--for", "2h"});
  EXPECT_EQ(options_of<AlarmsOptions>(maintenance).action, AlarmActionKind::kMaintenance);
  EXPECT_EQ(options_of<AlarmsOptions>(maintenance).duration, Duration(2h));
  const auto end = parse({"alarms", "maintenance", "a/b", "--end"});
  EXPECT_EQ(options_of<AlarmsOptions>(end).action, AlarmActionKind::kEndMaintenance);
  for (const auto& wrong : {std::vector<const char*>{"ack"},
                            {"ack", "a", "--limit", "top"},
                            {"shelve", "a"},
                            {"maintenance", "a/b"},
                            {"maintenance", "a/b/c", "--end"},
                            {"maintenance", "a/*", "--end"},
                            {"maintenance", "a/b", "--end", "--for", "1h"},
                            {"silence", "a"}}) {
    std::vector<const char*> all{"alarms"};
    all.insert(all.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(parse(all).error().code, ExitCode::kUsage) << wrong[0] << ' ' << wrong.back();
  }
}

TEST(Arguments, ATimeThatIsNoneOrEndsBeforeItBeginsIsRefused) {
  EXPECT_THAT(parse({"history", "a", "--from", "noon"}).error().text,
              HasSubstr("'noon' is no time"));
  EXPECT_THAT(parse({"history", "a", "--from", "1h", "--to", "2h"}).error().text,
              HasSubstr("not after the beginning"));
  EXPECT_EQ(parse({"history"}).error().code, ExitCode::kUsage);
  EXPECT_EQ(parse({"history", "a", "--csv", "--json"}).error().code, ExitCode::kUsage);
}

TEST(Arguments, TokensHaveAnEnd) {
  const auto added = parse({"token", "add", "wall", "--days", "30", "--store", "x.db"});
  const auto& token = options_of<TokenOptions>(added);
  EXPECT_EQ(token.action, AccessAction::kAdd);
  EXPECT_EQ(token.name, "wall");
  EXPECT_EQ(token.days, 30u);
  EXPECT_EQ(parse({"token", "add", "wall"}).error().code, ExitCode::kUsage);
  EXPECT_EQ(parse({"token", "add", "wall", "--days", "0"}).error().code, ExitCode::kUsage);
  EXPECT_EQ(options_of<TokenOptions>(parse({"token", "remove", "wall"})).action,
            AccessAction::kRemove);
}

TEST(Arguments, UsersAreAddedWithARoleAndNeverWithAPassword) {
  const auto added = parse(
      {"user", "add", "ann", "--role", "programmer", "--password-file", "-", "--store", "x.db"});
  const auto& user = options_of<UserOptions>(added);
  EXPECT_EQ(user.action, AccessAction::kAdd);
  EXPECT_EQ(user.name, "ann");
  EXPECT_EQ(user.role, Role::kProgrammer);
  EXPECT_EQ(options_of<UserOptions>(parse({"user", "add", "bob"})).role, Role::kViewer);
  EXPECT_EQ(options_of<UserOptions>(parse({"user", "remove", "ann"})).action,
            AccessAction::kRemove);
  EXPECT_EQ(parse({"user", "add", "eve", "--password", "x"}).error().code, ExitCode::kUsage);
  EXPECT_THAT(parse({"user", "add", "eve", "--role", "root"}).error().text,
              HasSubstr("viewer, operator, programmer or engineer"));
  EXPECT_EQ(parse({"user"}).error().code, ExitCode::kUsage);
}

TEST(Arguments, InterfacesMayBeRepeated) {
  const auto parsed = parse({"status", "--interface", "127.0.0.1", "--interface", "10.0.0.2"});
  EXPECT_THAT(options_of<StatusOptions>(parsed).connection.interfaces,
              testing::ElementsAre("127.0.0.1", "10.0.0.2"));
}

TEST(Arguments, DurationsAreOfOneGrammarAndANumberAloneIsSeconds) {
  const auto plan = [](const char* answer, const char* simulate) {
    return options_of<PlanOptions>(
        parse({"plan", "/dev/null", "--answer", answer, "--simulate", simulate}));
  };
  EXPECT_EQ(plan("0s", "30m").response_time, Duration{});
  EXPECT_EQ(plan("0s", "30m").simulate, Duration{30min});
  EXPECT_EQ(plan("500us", "1h").response_time, Duration{500us});
  EXPECT_EQ(plan("500us", "1d").simulate, Duration{24h});
  EXPECT_EQ(options_of<WatchOptions>(parse({"watch", "--for", "20"})).time, Duration{20s});
  EXPECT_THAT(parse({"watch", "--for", "0s"}).error().text,
              HasSubstr("--for: '0s' is too short; allowed: 1us to 365d"));
  EXPECT_THAT(parse({"watch", "--for", "5 sec"}).error().text,
              HasSubstr("'5 sec' is no duration; allowed: a number with us, ms, s, min, h or d, "
                        "1us to 365d; did you mean 5s?"));
}

TEST(Arguments, HelpIsNotAFault) {
  for (const auto& words :
       std::vector<std::vector<const char*>>{{"--help"}, {"watch", "--help"}, {"--version"}}) {
    const auto parsed = parse(words);
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().code, ExitCode::kOk);
    EXPECT_THAT(parsed.error().text, HasSubstr("fieldcast"));
  }
}

TEST(Arguments, EachCommandHasHelpAndRefusesAnUnknownOption) {
  ASSERT_GT(commands().size(), 20u);
  for (const CommandRow& row : commands()) {
    const std::string name(row.name);
    const auto help = parse({name.c_str(), "--help"});
    ASSERT_FALSE(help) << name;
    EXPECT_EQ(help.error().code, ExitCode::kOk) << name;
    EXPECT_THAT(help.error().text, HasSubstr(std::string(row.summary.substr(0, 20))));
    EXPECT_EQ(parse({name.c_str(), "--no-such-option"}).error().code, ExitCode::kUsage) << name;
  }
}

TEST(Arguments, FaultsSayWhatIsWrong) {
  const std::vector<std::pair<std::vector<const char*>, const char*>> faults{
      {{}, "subcommand"},
      {{"wach", "a"}, "did you mean watch?"},
      {{"frobnicate"}, "there are"},
      {{"--version=false", "status"}, "as the first word, got '--version=false'"},
      {{"alarms", "--store", "x.db"}, "goes with --from or --to"},
      {{"watch", "a/b/c/d"}, "more than three segments"},
      {{"watch", "--for", "soon"}, "is no duration"},
      {{"watch", "--domain", "233"}, "--domain"},
      {{"watch", "--config", "/nonexistent.yaml"}, "/nonexistent.yaml"},
      {{"write"}, "ASSIGNMENT"},
      {{"acquire", "a/b", "--count", "3"}, "--at"},
      {{"acquire", "a/b", "--at", "holding:1", "--count", "0"}, "--count"},
  };
  for (const auto& [words, text] : faults) {
    const auto parsed = parse(words);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, ExitCode::kUsage) << text;
    EXPECT_THAT(parsed.error().text, HasSubstr(text));
  }
}

}  // namespace
}  // namespace fieldcast::cli

#include "tools/forward/command/command_service.hpp"

#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>

#include "bridge/base/clock.hpp"
#include "tests/tools/forward/batch_support.hpp"

namespace fieldcast::forward {
namespace {

struct CommandServiceTest : testing::Test {
  Folder folder;
  std::string journal = folder.file("commands.db");
  std::vector<CommandRequest> executed;
  std::function<StationOutcome()> outcome = [] {
    return StationResult{.state = CommandState::kDone, .cause = "NONE"};
  };

  CommandService::Execute execute() {
    return [this](const CommandRequest& request, Duration) {
      executed.push_back(request);
      return outcome();
    };
  }
  static CommandSpec spec() { return {.rules = {{"anna", {Pattern()}}}}; }
  static std::string text(const std::string& id, std::int64_t seconds = 5) {
    return nlohmann::json{{"id", id},
                          {"channel", "line/press/setpoint"},
                          {"value", 1},
                          {"expires_at", read_clocks().utc.nanoseconds + seconds * 1'000'000'000}}
        .dump();
  }
  static nlohmann::json ask(CommandService& service, const std::string& text,
                            const std::string& user = "anna") {
    std::promise<std::string> response;
    service.on_request(
        {user, text, [&response](const std::string& json) { response.set_value(json); }});
    return nlohmann::json::parse(response.get_future().get());
  }
};

TEST_F(CommandServiceTest, ARepeatedRequestGetsTheFirstResultAlsoAfterARestart) {
  nlohmann::json first;
  {
    CommandService service(spec(), journal, execute());
    first = ask(service, text("1"));
    EXPECT_EQ(first.at("state"), "done");
    EXPECT_EQ(ask(service, text("1")), first);
    EXPECT_EQ(ask(service, text("2")).at("id"), "2");
  }
  CommandService service(spec(), journal, execute());
  EXPECT_EQ(ask(service, text("1")), first);
  EXPECT_EQ(ask(service, text("1", -5)), first) << "also when it has expired meanwhile";
  EXPECT_EQ(executed.size(), 2u);
}

TEST_F(CommandServiceTest, ACommandWithoutAResultIsUnknown) {
  outcome = [] { return tl::make_unexpected(StationFault::kNoResult); };
  CommandService service(spec(), journal, execute());
  EXPECT_EQ(ask(service, text("1")).at("state"), "unknown");
  outcome = [] { return tl::make_unexpected(StationFault::kNoBridge); };
  EXPECT_EQ(ask(service, text("2")).at("state"), "rejected");
  EXPECT_EQ(ask(service, text("1")).at("state"), "unknown");
  EXPECT_EQ(executed.size(), 2u);
}

TEST_F(CommandServiceTest, AfterACrashAPendingCommandIsNotRunAgain) {
  EXPECT_TRUE(CommandJournal(journal, "").begin("anna", "1", read_clocks().utc).is_new);
  CommandService service(spec(), journal, execute());
  EXPECT_EQ(ask(service, text("1")).at("state"), "unknown");
  EXPECT_TRUE(executed.empty());
}

TEST_F(CommandServiceTest, AResultThatCannotBeStoredIsSentAndTheCommandIsNotRunAgain) {
  outcome = [this]() -> StationOutcome {
    open_sqlite(journal, IfMissing::kFail)
        ->script(
            "create trigger full before update on commands begin "
            "select raise(fail, 'disk full'); end;");
    return StationResult{.state = CommandState::kDone, .cause = "NONE"};
  };
  CommandService service(spec(), journal, execute());
  const nlohmann::json first = ask(service, text("1"));
  EXPECT_EQ(first.at("state"), "done");
  EXPECT_EQ(first.at("id"), "1");
  const nlohmann::json repeated = ask(service, text("1"));
  EXPECT_EQ(repeated.at("state"), "unknown");
  EXPECT_EQ(repeated.at("id"), "1");
  EXPECT_EQ(executed.size(), 1u);
}

TEST_F(CommandServiceTest, ARefusedRequestIsNotRun) {
  CommandService service(spec(), journal, execute());
  EXPECT_EQ(ask(service, text("1"), "ben").at("state"), "rejected");
  EXPECT_EQ(ask(service, text("1", -1)).at("state"), "expired");
  EXPECT_EQ(ask(service, "{").at("state"), "rejected");
  EXPECT_TRUE(executed.empty());
  EXPECT_EQ(ask(service, text("1")).at("state"), "done") << "it was never run";
  service.close();
  EXPECT_EQ(ask(service, text("2")).at("state"), "rejected");
}

}  // namespace
}  // namespace fieldcast::forward

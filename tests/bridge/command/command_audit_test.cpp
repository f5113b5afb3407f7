#include "bridge/store/command_audit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/message_text.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using test::RecordingAudit;

Command write_of(std::uint64_t id, std::vector<Value> values) {
  Command command;
  command.requester = "panel";
  command.request_id = id;
  command.device = "press";
  command.target = ChannelTarget{"setpoint"};
  command.values = std::move(values);
  return command;
}

CommandResult result_of(const Command& command, CommandState state, Cause cause = Cause::kNone,
                        std::string reason = {}) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.state = state;
  result.cause = cause;
  result.reason = std::move(reason);
  return result;
}

TEST(CommandAudit, NamesTheAuthenticatedSubjectBeforeTheRequester) {
  Command command = write_of(1, {21.5});
  EXPECT_EQ(audit_entry("line", command).who, "panel");
  command.subject = "plant mes";
  EXPECT_EQ(audit_entry("line", command).who, "plant mes (panel)");
}

TEST(CommandAudit, HasOneEntryForEachCommandWithWhatBecameOfIt) {
  RecordingAudit audit;
  CommandAudit commands;
  commands.open(&audit);
  const Command first = write_of(1, {21.5});
  Command second = write_of(2, {});
  second.operation = Operation::kAcquire;
  second.target = AddressTarget{"holding:100", {}};
  commands.asked("line", first);
  commands.asked("line", second);
  commands.completed("line",
                     result_of(second, CommandState::kFailed, Cause::kNoResponse, "no response"));
  commands.completed("line", result_of(first, CommandState::kVerified));
  EXPECT_EQ(audit.rows(), (std::vector<std::string>{
                              "panel | acquire | line/press at holding:100 | failed: no response",
                              "panel | write 21.5 | line/press/setpoint | verified"}));
  EXPECT_GT(audit.entries()[1].at.nanoseconds, 0);
}

TEST(CommandAudit, ARefusedDuplicateLeavesTheCommandThatRuns) {
  RecordingAudit audit;
  CommandAudit commands;
  commands.open(&audit);
  const Command command = write_of(1, {std::int64_t{7}});
  commands.asked("line", command);
  const AuditEntry again = commands.asked("line", write_of(1, {std::int64_t{8}}));
  commands.refused(again,
                   result_of(command, CommandState::kRejected, Cause::kDuplicate, "seen before"));
  commands.completed("line", result_of(command, CommandState::kDone));
  const auto entries = audit.entries();
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].what + ": " + entries[0].result, "write 8: rejected: seen before");
  EXPECT_EQ(entries[1].what + ": " + entries[1].result, "write 7: done");
}

TEST(CommandAudit, LongListsAreCutAndStillCounted) {
  EXPECT_EQ(audit_entry("line", write_of(1, std::vector<Value>(2048, Value{true}))).what,
            "write true true true true true true true true .. (2048 values)");
  EXPECT_LT(audit_entry("line", write_of(1, {std::string(100'000, 'x')})).what.size(), 200u);
}

TEST(CommandAudit, ATextIsShownAsPrintableUtf8) {
  EXPECT_EQ(audit_entry("line", write_of(1, {std::string("a\n\xFF")})).what, "write a\\n\\xFF");
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "ü";
  const std::string what = audit_entry("line", write_of(1, {umlauts})).what;
  EXPECT_TRUE(is_utf8(what)) << what;
  Command command = write_of(1, {true});
  command.target = AddressTarget{"holding:\xFF", {}};
  EXPECT_EQ(audit_entry("line", command).target, "line/press at holding:\\xFF");
}

TEST(CommandAudit, WithoutAStoreNothingIsHeld) {
  CommandAudit commands;
  const Command command = write_of(1, {true});
  commands.asked("line", command);
  RecordingAudit audit;
  commands.open(&audit);
  commands.completed("line", result_of(command, CommandState::kDone));
  ASSERT_EQ(audit.entries().size(), 1u);
  EXPECT_EQ(audit.entries()[0].what, "command") << "asked before there was a store";
}

}  // namespace
}  // namespace fieldcast

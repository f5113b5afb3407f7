#include "bridge/standby/standby_group.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "bridge/base/clock.hpp"

namespace fieldcast {
namespace {

class StandbyGroupTest : public testing::Test {
 protected:
  StandbyGroupTest() {
    StandbyMessage other{.group = "g"};
    other.member.bridge = "b";
    other.member.since = 2;
    group_.on_member(other);  // ready, without notes
  }
  // Begins a write; `noted_` becomes whether it may run, and is empty until then.
  void begin(std::uint64_t id) {
    group_.begin("bus", "plant", id, [this](bool noted) { noted_ = noted; });
  }
  void other_says(StandbyNoteKind kind, std::uint64_t id) {
    group_.on_note({"g", "b", 1, ++number_, kind, "bus", "plant", id});
  }

  std::uint64_t number_ = 0;
  std::vector<StandbyNote> told_;
  std::optional<bool> noted_;
  MasterLease lease_;
  StandbyGroup group_{"g",
                      {.bridge = "a", .since = 1},
                      lease_,
                      {.tell = [](const StandbyMessage&) {},
                       .note = [this](const StandbyNote& note) { told_.push_back(note); },
                       .figures = [] { return std::vector<StandbyBusFigures>{}; },
                       .readers_came = [] { return false; },
                       .changed = [] {},
                       .noted = [](const StandbyNote&) {},
                       .held = [](const StandbyNote&) {}}};
};

// This member was suspended while the command was in its queue.
TEST_F(StandbyGroupTest, AWriteThatAnotherOneHasBegunDoesNotRunOnceMore) {
  begin(7);
  EXPECT_EQ(noted_, std::nullopt) << "nobody knows yet who is master";
  other_says(StandbyNoteKind::kBegun, 8);
  EXPECT_EQ(noted_, std::nullopt) << "that was another write";
  other_says(StandbyNoteKind::kBegun, 7);
  EXPECT_EQ(noted_, false);
}

TEST_F(StandbyGroupTest, AWriteThatComesBehindTheWordThatAnotherOneHasBegunItDoesNotRun) {
  other_says(StandbyNoteKind::kBegun, 7);
  begin(7);
  EXPECT_EQ(noted_, false);
  EXPECT_TRUE(told_.empty()) << "it does not begin here";
}

TEST_F(StandbyGroupTest, AWriteThatAnotherOneHasAnsweredDoesNotRunOnceMore) {
  begin(7);
  other_says(StandbyNoteKind::kAnswered, 7);
  EXPECT_EQ(noted_, false);
}

TEST_F(StandbyGroupTest, AMemberIsToldOfWhatHasItsResult) {
  group_.tell_answered("bus", "plant", 7);
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_EQ(told_[0].kind, StandbyNoteKind::kAnswered);
  EXPECT_EQ(told_[0].request_id, 7u);
  EXPECT_EQ(told_[0].number, 0u) << "not all have to note it";
}

TEST_F(StandbyGroupTest, AWriteThatWasGivenBackRuns) {
  other_says(StandbyNoteKind::kBegun, 7);
  other_says(StandbyNoteKind::kReturned, 7);
  begin(7);
  EXPECT_EQ(noted_, std::nullopt) << "it waits until it is noted";
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_EQ(told_[0].kind, StandbyNoteKind::kBegun);
}

}  // namespace
}  // namespace fieldcast

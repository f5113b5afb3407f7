#include "bridge/standby/standby_group.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/standby/bus_guard.hpp"
#include "bridge/standby/member_identity.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

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
TEST_F(StandbyGroupTest, AWriteThatASecondBridgeHasBegunDoesNotRunAgain) {
  begin(7);
  EXPECT_EQ(noted_, std::nullopt) << "nobody knows yet who is master";
  other_says(StandbyNoteKind::kBegun, 8);
  EXPECT_EQ(noted_, std::nullopt) << "that was another write";
  other_says(StandbyNoteKind::kBegun, 7);
  EXPECT_EQ(noted_, false);
}

TEST_F(StandbyGroupTest, AWriteThatArrivesAfterASecondBridgeHasBegunItDoesNotRun) {
  other_says(StandbyNoteKind::kBegun, 7);
  begin(7);
  EXPECT_EQ(noted_, false);
  EXPECT_TRUE(told_.empty()) << "it does not begin here";
}

TEST_F(StandbyGroupTest, AWriteWithTheResultOfASecondBridgeDoesNotRunAgain) {
  begin(7);
  other_says(StandbyNoteKind::kCompleted, 7);
  EXPECT_EQ(noted_, false);
}

TEST_F(StandbyGroupTest, AMemberIsNotifiedOfWhatHasItsResult) {
  group_.tell_completed("bus", "plant", 7);
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_EQ(told_[0].kind, StandbyNoteKind::kCompleted);
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

constexpr Instant kBegan{std::chrono::hours{1}};

Duration settled_after(bool in_group, const std::function<Finding(Duration)>& at) {
  Settling settling(in_group, kBegan);
  Duration after{};
  while (after < 1min && settling.waits_for(at(after), kBegan + after)) after += 10ms;
  return after;
}

TEST(Settling, WhoIsAloneWaitsASecond) {
  const auto nobody = [](Duration) { return Finding{}; };
  EXPECT_EQ(settled_after(false, nobody), 1s);
  EXPECT_EQ(settled_after(true, nobody), 1s);
}

TEST(Settling, AMemberWaitsForADiscoveryServerAndForWhatItKnows) {
  const auto server = [](Duration answers) {
    return [answers](Duration after) { return Finding{true, after >= answers}; };
  };
  EXPECT_EQ(settled_after(true, server(100ms)), 2100ms);
  EXPECT_EQ(settled_after(true, server(4s)), 6s);
  EXPECT_EQ(settled_after(true, server(1h)), Settling::kMostInGroup);
  EXPECT_EQ(settled_after(false, server(1h)), 1s) << "a bridge without a group is as before";
}

TEST(Settling, WhoIsThereAndNotKnownYetIsWaitedFor) {
  const auto known = [](Duration from) {
    return [from](Duration after) { return Finding{.unknown = after < from ? 1u : 0u}; };
  };
  EXPECT_EQ(settled_after(true, known(500ms)), 1s);
  EXPECT_EQ(settled_after(true, known(2s)), 2290ms) << "until it is heard as a member, too";
  EXPECT_EQ(settled_after(true, known(1h)), Settling::kMostInGroup);
  EXPECT_EQ(settled_after(false, known(1h)), Settling::kMost);
}

// Behind a discovery server, a killed bridge may look like a silent one.
TEST(Settling, WhoIsSilentIsNotWaitedForAsLong) {
  const auto silent = [](Duration) { return Finding{.silent = 1}; };
  EXPECT_EQ(settled_after(true, silent), Settling::kMost);
  EXPECT_EQ(settled_after(false, silent), Settling::kMost);
}

BridgeSpec with(const Encoding& encoding) {
  ChannelSpec channel;
  channel.name = "power";
  channel.encoding = encoding;
  DeviceSpec device;
  device.channels = {channel};
  BusSpec bus;
  bus.devices = {device};
  BridgeSpec bridge;
  bridge.buses = {bus};
  return bridge;
}

TEST(CommonConfiguration, IsAnotherWithAnotherExponent) {
  const std::string none = common_configuration(with({}));
  const std::string behind = common_configuration(with({.exponent_distance = 2}));
  EXPECT_EQ(none, common_configuration(with({})));
  EXPECT_NE(none, behind);
  EXPECT_NE(behind, common_configuration(with({.exponent_distance = -2})));
  // As before there were exponents, or a group is not one while its members are upgraded.
  EXPECT_EQ(none, "af37ba9c1dc337a2");
}

TEST(CommonConfiguration, IsAnotherWithAnotherFormOfATextOrAnotherMeter) {
  const auto number = [](TextNumber::Kind kind) {
    return common_configuration(
        with({.type = ValueType::kUint16, .string_bytes = 4, .text_number = {.kind = kind}}));
  };
  EXPECT_NE(number(TextNumber::Kind::kDecimal), number(TextNumber::Kind::kHex));
  const auto text = [](Charset charset) {
    return common_configuration(
        with({.type = ValueType::kString, .string_bytes = 4, .charset = charset}));
  };
  EXPECT_NE(text(Charset::kLatin1), text(Charset::kGbk));
  const auto meter = [](const std::string& address) {
    BridgeSpec bridge = with({});
    bridge.buses[0].devices[0].link = {.address = 65535, .long_address = address};
    return common_configuration(bridge);
  };
  EXPECT_NE(meter("398192000337"), meter("398192000338"));
}

TEST(CommonConfiguration, IsAnotherWithOtherLimits) {
  const auto sum = [](const auto& change) {
    BridgeSpec bridge = with({});
    change(bridge.buses[0].devices[0].channels[0]);
    return common_configuration(bridge);
  };
  const std::set<std::string> sums{
      sum([](ChannelSpec&) {}),
      sum([](ChannelSpec& channel) { channel.limits.high = 80; }),
      sum([](ChannelSpec& channel) { channel.limits.high = 81; }),
      sum([](ChannelSpec& channel) { channel.limits.high_high = 80; }),
      sum([](ChannelSpec& channel) { channel.limits.priority = AlarmPriority::kLow; }),
      sum([](ChannelSpec& channel) { channel.write_min = 80; }),
      sum([](ChannelSpec& channel) { channel.write_max = 80; }),
      sum([](ChannelSpec& channel) { channel.write_max = 80.5; }),
      sum([](ChannelSpec& channel) { channel.write_interval = 80ns; })};
  EXPECT_EQ(sums.size(), 9u);
}

TEST(CommonConfiguration, IsAnotherWithOtherFramesOfADeclaredProtocol) {
  const auto sum = [](const auto& change) {
    declared::Declaration declaration;
    declaration.areas.emplace_back();
    declaration.operations.emplace_back().response.fields.resize(2);
    change(declaration);
    BridgeSpec bridge = with({});
    bridge.buses[0].devices[0].declaration.value =
        std::make_shared<const declared::Declaration>(declaration);
    return common_configuration(bridge);
  };
  const auto of_field = [&](const auto& change) {
    return sum([&](declared::Declaration& declaration) {
      change(declaration.operations[0].response.fields[1]);
    });
  };
  using declared::Declaration, declared::Field;
  const std::set<std::string> sums{
      common_configuration(with({})),
      sum([](Declaration&) {}),
      sum([](Declaration& declaration) { declaration.areas[0].origin = 1; }),
      sum([](Declaration& declaration) { declaration.operations[0].command = 1; }),
      sum([](Declaration& declaration) { declaration.operations[0].request.fields.resize(1); }),
      of_field([](Field& field) { field.word.little_endian = true; }),
      of_field([](Field& field) { field.text_number.decimals = 2; }),
      of_field([](Field& field) { field.exponent = std::uint8_t{0}; }),
      of_field([](Field& field) { field.key = "1.8.0"; })};
  EXPECT_EQ(sums.size(), 9u);
  // Members of two versions share the sum if only the texts for the user differ.
  EXPECT_EQ(sum([](Declaration& declaration) { declaration.summary = "a meter"; }),
            sum([](Declaration&) {}));
}

struct Child {
  Child() {
    int ends[2];
    if (::pipe(ends) != 0) std::abort();
    pid = ::fork();
    if (pid == 0) {
      const std::string own = own_process_identity();
      (void)!::write(ends[1], own.data(), own.size());
      ::close(ends[1]);
      ::pause();
      ::_exit(0);
    }
    ::close(ends[1]);
    char buffer[256];
    for (ssize_t size = 0; (size = ::read(ends[0], buffer, sizeof buffer)) > 0;) {
      identity.append(buffer, static_cast<std::size_t>(size));
      if (identity.size() > 60) break;
    }
    ::close(ends[0]);
  }
  pid_t pid = 0;
  std::string identity;
};

TEST(ProcessIdentity, ReportsWhetherAProcessOfThisKernelHasEnded) {
  const Child child;
  EXPECT_FALSE(has_ended(child.identity)) << child.identity;
  ::kill(child.pid, SIGKILL);
  siginfo_t ended{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child.pid), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(has_ended(child.identity)) << "not yet waited for";
  ::waitpid(child.pid, nullptr, 0);
  EXPECT_TRUE(has_ended(child.identity));
  EXPECT_FALSE(has_ended(own_process_identity()));
}

TEST(ProcessIdentity, SaysNothingOfOtherMachinesAndContainers) {
  for (const char* other : {"", "x", "boot/pid:[1]/999999/5", "////"})
    EXPECT_FALSE(has_ended(other));
  std::string same_pid = own_process_identity();
  same_pid += '0';  // another start time: not the same process
  EXPECT_TRUE(has_ended(same_pid));
}

}  // namespace
}  // namespace fieldcast

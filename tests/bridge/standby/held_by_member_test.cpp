// Tests a command that only reached a standby. One member is a real bridge, one is simulated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "bridge/dds/endpoints/standby_channel.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/station/subscription.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/process.hpp"
#include "tests/bridge/support/tcp_device.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

class PlayedMember {
 public:
  explicit PlayedMember(std::uint32_t domain)
      : domain_(spec(domain), "played", nullptr),
        results_(domain_, kCommandResultTopic,
                 {[this](const idl::CommandResult& result) { on_result(result); }, {}, {}}),
        commands_(domain_.writer(kCommandTopic, command_writer_qos(60s), "plant-system")),
        actions_(domain_.writer(kAlarmActionTopic, alarm_action_writer_qos(10s), "plant-system")),
        channel_(domain_, "played", "g", UtcTime{1},
                 {[this](const StandbyMessage& message) { on_member(message); },
                  [](const std::string&) {}, [this](const StandbyNote& note) { on_note(note); },
                  [](const StandbyRequest&) {}}),
        beats_([this] { beat(); }) {}
  ~PlayedMember() { leave(); }

  void leave() {
    ending_ = true;
    if (beats_.joinable()) beats_.join();
  }
  [[nodiscard]] bool has_readers() const {
    dds::PublicationMatchedStatus of_commands, of_actions;
    commands_->get_publication_matched_status(of_commands);
    actions_->get_publication_matched_status(of_actions);
    return of_commands.current_count > 0 && of_actions.current_count > 0;
  }
  void write(std::uint64_t id) {
    Command command;
    command.requester = "plant-system";
    command.request_id = id;
    command.device = "plc";
    command.target = ChannelTarget{"level"};
    command.values = {Value{id}};
    idl::Command out;
    ASSERT_TRUE(to_idl("one", command, out));
    commands_->write(&out);
  }
  void act(std::uint64_t id) {
    AlarmAction action;
    action.requester = "plant-system";
    action.request_id = id;
    action.kind = AlarmActionKind::kMaintenance;
    action.alarm.bus = "one";
    action.alarm.device = "plc";
    action.by = "anna";
    action.duration = 1min;
    idl::AlarmAction out;
    ASSERT_TRUE(to_idl(action, out));
    actions_->write(&out);
  }
  void tell(StandbyNoteKind kind, std::uint64_t id) {
    channel_.tell(StandbyNote{"g", "played", 0, 0, kind, "one", "plant-system", id});
  }
  [[nodiscard]] std::set<std::uint64_t> told() {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  [[nodiscard]] std::set<std::uint64_t> answered() {
    const std::lock_guard lock(mutex_);
    return answered_;
  }
  [[nodiscard]] std::vector<StationResult> results_of(std::uint64_t id) {
    const std::lock_guard lock(mutex_);
    return results_by_id_[id];
  }

 private:
  static DdsSpec spec(std::uint32_t domain) {
    DdsSpec spec;
    spec.domain = domain;
    return spec;
  }
  void beat() {
    StandbyMessage message;
    message.group = "g";
    message.member.bridge = "played";
    message.member.since = 1;
    message.member.strength = 9;
    message.member.role = StandbyRole::kMaster;
    while (!ending_) {
      ++message.member.beat;
      message.member.term = term_;
      message.member.configuration = configuration();
      channel_.tell(message);
      std::this_thread::sleep_for(50ms);
    }
    ++message.member.beat;
    message.member.role = StandbyRole::kLeft;
    channel_.tell(message);
  }
  // Equal to that of the real one, which would not take over otherwise.
  std::string configuration() {
    const std::lock_guard lock(mutex_);
    return configuration_;
  }
  // This process was delayed and the bridge has taken over: it must wait again.
  void on_member(const StandbyMessage& message) {
    {
      const std::lock_guard lock(mutex_);
      configuration_ = message.member.configuration;
    }
    if (message.member.role == StandbyRole::kMaster && message.member.term > term_)
      term_ = StandbyTerm{number_of(message.member.term) + 1} << 32;
  }
  void on_note(const StandbyNote& note) {
    const std::lock_guard lock(mutex_);
    if (note.bridge != "real") return;
    if (note.kind == StandbyNoteKind::kCompleted) answered_.insert(note.request_id);
    if (note.term != 0) return;
    EXPECT_EQ(note.kind, StandbyNoteKind::kReturned) << "nobody has begun it";
    EXPECT_EQ(note.bus, "one");
    told_.insert(note.request_id);
  }
  void on_result(const idl::CommandResult& result) {
    const std::lock_guard lock(mutex_);
    results_by_id_[result.request_id()].push_back(from_idl(result));
  }

  std::mutex mutex_;
  std::set<std::uint64_t> told_, answered_;
  std::string configuration_;
  std::map<std::uint64_t, std::vector<StationResult>> results_by_id_;
  std::atomic<StandbyTerm> term_ = StandbyTerm{5} << 32;
  std::atomic<bool> ending_ = false;
  Domain domain_;
  Subscription<idl::CommandResultPubSubType> results_;
  dds::DataWriter* commands_;
  dds::DataWriter* actions_;
  StandbyChannel channel_;
  std::thread beats_;
};

struct HeldByMember : testing::Test {
  ~HeldByMember() override { std::filesystem::remove(file); }
  static bool within(const std::function<bool()>& condition, Duration limit = 20s) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(2ms);
    }
    return true;
  }
  std::unique_ptr<test::Process> launch() const {
    std::ofstream(file) << "bridge: { name: real, standby: { group: g } }\ndds: { domain: "
                        << domain.number()
                        << " }\nbuses:\n  - name: one\n    port: { tcp: 127.0.0.1:" << device.port()
                        << " }\n    protocol: modbus-tcp\n    devices:\n      - name: plc\n"
                           "        address: 1\n        channels:\n          - { name: level, at: "
                           "\"holding:9\", type: uint16, access: read-write, refresh: 200ms }\n";
    return std::make_unique<test::Process>(FIELDCAST_BRIDGE, std::vector<std::string>{file});
  }
  StationResult answer_to(StandbyNoteKind kind, std::uint64_t id) {
    (void)within([&] {
      member.tell(kind, id);
      return within([&] { return !member.results_of(id).empty(); }, 1s);
    });
    return result_of(id);
  }
  StationResult result_of(std::uint64_t id) {
    EXPECT_TRUE(within([&] { return !member.results_of(id).empty(); })) << id;
    const auto results = member.results_of(id);
    return results.empty() ? StationResult{} : results.front();
  }

  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     ("fieldcast-held-" + std::to_string(::getpid()) + ".yaml");
  test::ClaimedDomain domain;
  test::TcpDevice device;
  PlayedMember member{domain.number()};
};

TEST_F(HeldByMember, NotifiesTheMasterWhichSendsMissingResults) {
  const auto bridge = launch();
  ASSERT_TRUE(within([&] { return member.has_readers(); }));
  for (std::uint64_t id = 1; id < 10 && member.told().size() < 2; ++id) {
    member.write(2 * id);
    member.act(2 * id + 1);
    (void)within([&] { return member.told().size() >= 2; }, 5s);
  }
  const auto all = member.told();
  ASSERT_GE(all.size(), 2U) << "the master is not told";
  const std::uint64_t held = *all.begin(), action = held + 1;
  ASSERT_TRUE(all.contains(action));

  member.leave();
  EXPECT_EQ(result_of(held).state, CommandState::kDone) << "who takes over runs what it holds";
  EXPECT_THAT(result_of(action).reason, Not(HasSubstr("send it again")));
  member.tell(StandbyNoteKind::kReturned, held);
  member.tell(StandbyNoteKind::kReturned, action);
  const StationResult never_came = answer_to(StandbyNoteKind::kReturned, 101);
  const StationResult begun = answer_to(StandbyNoteKind::kBegun, 102);
  EXPECT_EQ(never_came.state, CommandState::kRejected);
  EXPECT_EQ(never_came.cause, to_name(Cause::kShutdown)) << "stations send it again by that";
  EXPECT_THAT(never_came.reason, HasSubstr("send it again"));
  EXPECT_EQ(begun.state, CommandState::kFailed);
  EXPECT_THAT(begun.reason, HasSubstr("unknown whether it took effect"));
  EXPECT_EQ(member.results_of(held).size(), 1U) << "it was known";
  EXPECT_TRUE(within([&] {
    return member.answered() == std::set{held, action};
  })) << "who holds it may not have heard its result";
  EXPECT_EQ(member.results_of(action).size(), 1U);
  EXPECT_EQ(device.writes()[static_cast<std::uint16_t>(held)], 1);
}

}  // namespace
}  // namespace fieldcast

// Tests several runs of one bus: a bridge that is killed and restarts, and two bridges at the same
// time. Uses the real processes, devices that count writes, and a plant system whose writer keeps
// its commands for late joiners, unlike the stations of Fieldcast.
#include <gmock/gmock.h>
#include <signal.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/station/subscription.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/discovery_record.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/process.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr std::uint64_t kCommands = 20;

bool within(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + seconds{20};
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::yield();
  }
  return true;
}

class PlantSystem {
 public:
  explicit PlantSystem(std::uint32_t domain)
      : domain_(
            [&] {
              DdsSpec spec;
              spec.domain = domain;
              return spec;
            }(),
            "plant-system", &discovered_),
        results_(domain_, kCommandResultTopic,
                 {[this](const idl::CommandResult& result) { note(result); }, {}, {}}),
        commands_(domain_.writer(kCommandTopic, command_writer_qos(seconds{60}), "plant-system",
                                 discovered_.matches(), dds::StatusMask::publication_matched())) {}

  [[nodiscard]] testing::AssertionResult matched_by(int bridges) {
    dds::PublicationMatchedStatus status;
    if (within([&] {
          commands_->get_publication_matched_status(status);
          return status.current_count == bridges;
        }))
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << status.current_count << " bridges matched instead of "
                                       << bridges << "; " << discovered_.text();
  }
  void write(std::uint64_t id) {
    written_[id] = now();
    write(id, written_[id]);
  }
  // Writes the same command with its old time, as a writer that keeps commands for late joiners.
  void write_again(std::uint64_t id) { write(id, written_.at(id)); }
  [[nodiscard]] std::optional<StationResult> result(std::uint64_t id, std::size_t n = 1) {
    std::optional<StationResult> found;
    (void)within([&] {
      const std::lock_guard lock(mutex_);
      if (results_by_id_[id].size() >= n) found = results_by_id_[id][n - 1];
      return found.has_value();
    });
    return found;
  }
  [[nodiscard]] std::size_t results_of(std::uint64_t id) {
    const std::lock_guard lock(mutex_);
    return results_by_id_[id].size();
  }

 private:
  static DdsTime now() {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const auto whole = std::chrono::floor<seconds>(since);
    return {static_cast<std::int32_t>(whole.count()),
            static_cast<std::uint32_t>(std::chrono::nanoseconds(since - whole).count())};
  }
  void write(std::uint64_t id, const DdsTime& at) {
    Command command;
    command.requester = "plant-system";
    command.request_id = id;
    command.device = "plc";
    command.target = ChannelTarget{"level"};
    command.values = {Value{id}};
    idl::Command out;
    ASSERT_TRUE(to_idl("one", command, out));
    ASSERT_EQ(commands_->write_w_timestamp(&out, dds::HANDLE_NIL, at), ReturnCode_t::RETCODE_OK);
  }
  void note(const idl::CommandResult& result) {
    const std::lock_guard lock(mutex_);
    results_by_id_[result.request_id()].push_back(from_idl(result));
  }

  std::mutex mutex_;
  std::map<std::uint64_t, std::vector<StationResult>> results_by_id_;
  std::map<std::uint64_t, DdsTime> written_;
  test::DiscoveryRecord discovered_;  // before the domain, which calls it
  Domain domain_;
  Subscription<idl::CommandResultPubSubType> results_;
  dds::DataWriter* commands_;
};

struct RestartTest : testing::Test {
  RestartTest() {
    folder = std::filesystem::path(testing::TempDir()) /
             ("fieldcast-restart-" + std::to_string(::getpid()) +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
  }
  ~RestartTest() override { std::filesystem::remove_all(folder); }

  std::unique_ptr<test::Process> launch(const std::string& name, const test::Pty& at,
                                        const std::string& more = "") {
    const std::string file = folder / (name + ".yaml");
    std::ofstream(file) << "bridge: " << name << "\ndds: { domain: " << domain.number() << " }\n"
                        << more << "buses:\n  - name: one\n    port: { serial: " << at.path()
                        << ", baud: 115200 }\n    protocol: modbus-rtu\n"
                        << "    defaults: { timeout: 3s }\n    devices:\n"
                        << "      - name: plc\n        address: 1\n        channels:\n"
                        << "          - { name: level, at: \"holding:0\", type: uint16, "
                        << "access: read-write, refresh: 1s }\n";
    return std::make_unique<test::Process>(FIELDCAST_BRIDGE, std::vector<std::string>{file});
  }
  std::unique_ptr<test::Process> start(test::ModbusDevice& device, const std::string& more = "") {
    const unsigned reads = device.reads();
    auto bridge = launch("test", pty, more);
    EXPECT_THAT(bridge->said("one: the port is open"), HasSubstr("one: the port is open"));
    EXPECT_TRUE(within([&] { return device.reads() > reads; }));
    return bridge;
  }
  // Checks that the first bridge serves and the second waits; then `end` ends the first.
  void of_two_one_serves(const std::function<void(std::unique_ptr<test::Process>&)>& end) {
    test::Pty other_pty;
    test::ModbusDevice device(pty), other_device(other_pty);
    PlantSystem plant(domain.number());
    auto first = start(device);
    const auto second = launch("second", other_pty);
    ASSERT_THAT(second->said("names of buses are unique"),
                HasSubstr("one: not served here: bridge 'test' on host"));
    ASSERT_TRUE(plant.matched_by(2));
    plant.write(1);
    plant.write(2);
    for (const std::uint64_t id : {1, 2}) {
      const auto result = plant.result(id);
      ASSERT_TRUE(result);
      EXPECT_EQ(result->state, CommandState::kDone) << result->reason;
    }
    EXPECT_EQ(plant.results_of(1), 1u);
    EXPECT_EQ(device.writes(), 2u);
    EXPECT_EQ(other_device.writes() + other_device.reads(), 0u) << "the second touches its line";

    end(first);
    const auto ended = std::chrono::steady_clock::now();
    EXPECT_THAT(second->said("one: the port is open"),
                testing::AllOf(HasSubstr("one: taken over"), HasSubstr("one: the port is open")));
    EXPECT_LT(std::chrono::steady_clock::now() - ended, seconds{5});
    plant.write(3);
    const auto result = plant.result(3);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->state, CommandState::kDone) << result->reason;
    EXPECT_EQ(other_device.writes(), 1u);
  }

  test::ClaimedDomain domain;
  test::Pty pty;
  std::filesystem::path folder;
};

TEST_F(RestartTest, CommandsOfTheFirstLifeAreNotExecutedAgain) {
  test::ModbusDevice device(pty);
  PlantSystem plant(domain.number());
  {  // the first bridge is killed at the end, without leaving the domain
    const auto first = start(device);
    ASSERT_TRUE(plant.matched_by(1));
    for (std::uint64_t id = 1; id <= kCommands; ++id) plant.write(id);
    for (std::uint64_t id = 1; id <= kCommands; ++id) {
      const auto result = plant.result(id);
      ASSERT_TRUE(result) << id;
      EXPECT_EQ(result->state, CommandState::kDone) << result->reason;
    }
  }
  ASSERT_TRUE(plant.matched_by(0));
  const auto second = start(device);
  ASSERT_TRUE(plant.matched_by(1));
  for (std::uint64_t id = 1; id <= kCommands; ++id) plant.write_again(id);
  for (std::uint64_t id = 1; id <= kCommands; ++id) {
    const auto result = plant.result(id, 2);
    ASSERT_TRUE(result) << id;
    EXPECT_EQ(result->state, CommandState::kRejected);
    EXPECT_THAT(result->reason, HasSubstr("before this bridge began to listen"));
  }
  plant.write(kCommands + 1);
  const auto fresh = plant.result(kCommands + 1);
  ASSERT_TRUE(fresh);
  EXPECT_EQ(fresh->state, CommandState::kDone) << fresh->reason;
  EXPECT_EQ(device.writes(), kCommands + 1);
}

// A plant system that repeats a command with the same identity and the current time.
TEST_F(RestartTest, AStoreKnowsTheCommandsOfTheFirstLife) {
  test::ModbusDevice device(pty);
  PlantSystem plant(domain.number());
  const std::string store = "store: { path: " + (folder / "store.db").string() + " }\n";
  {
    const auto first = start(device, store);
    ASSERT_TRUE(plant.matched_by(1));
    plant.write(1);
    const auto result = plant.result(1);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->state, CommandState::kDone) << result->reason;
  }
  ASSERT_TRUE(plant.matched_by(0));  // the next bridge receives what is written now
  const auto second = start(device, store);
  ASSERT_TRUE(plant.matched_by(1));
  plant.write(1);
  plant.write(2);
  const auto fresh = plant.result(2);
  ASSERT_TRUE(fresh);
  EXPECT_EQ(fresh->state, CommandState::kDone) << fresh->reason;
  std::size_t refused = 0;
  for (std::size_t n = 2; const auto result = refused < 1 ? plant.result(1, n) : std::nullopt; ++n)
    refused += result->cause == to_name(Cause::kDuplicate);
  EXPECT_EQ(refused, 1u);
  EXPECT_EQ(device.writes(), 2u);
}

TEST_F(RestartTest, OfTwoBridgesOfOneBusTheFirstServesUntilItEnds) {
  of_two_one_serves([](std::unique_ptr<test::Process>& first) {
    first->signal(SIGTERM);
    EXPECT_EQ(first->exit_code(), 0) << first->output();
  });
}

// The lease lasts longer, but on the same host the end of the process is detected immediately.
TEST_F(RestartTest, OfTwoBridgesOfOneBusTheFirstServesUntilItIsKilled) {
  of_two_one_serves([](std::unique_ptr<test::Process>& first) { first.reset(); });
}

TEST_F(RestartTest, ABridgeThatWasKilledDoesNotHoldUpItsNextLife) {
  test::ModbusDevice device(pty);
  { const auto first = start(device); }
  const auto began = std::chrono::steady_clock::now();
  const auto second = start(device);
  EXPECT_LT(std::chrono::steady_clock::now() - began, seconds{5});
  EXPECT_THAT(second->output(), testing::Not(HasSubstr("not served here")));
}

}  // namespace
}  // namespace fieldcast

// Tests a member whose role changes before the thread of roles has followed the last change. The
// test is that thread, and it plays the second member of the group.
#include "bridge/role/membership.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <future>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/dds/endpoints/standby_channel.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using testing::eventually;

// The second member.
class Second {
 public:
  Second() {
    own_.group = "g";
    own_.member.bridge = "second";
    own_.member.since = 1;
  }
  void tell(StandbyRole role, StandbyTerm term = 0) {
    own_.member.role = role;
    own_.member.term = term;
    ++own_.member.beat;
    {
      const std::lock_guard lock(mutex_);
      own_.member.configuration = first_.configuration;
    }
    channel_.tell(own_);
  }
  [[nodiscard]] StandbyMember first() const {
    const std::lock_guard lock(mutex_);
    return first_;
  }

 private:
  mutable std::mutex mutex_;
  StandbyMember first_;
  StandbyMessage own_;
  Domain domain_{testing::loopback(), "second", nullptr};
  StandbyChannel channel_{
      domain_, "second", "g", UtcTime{1},
      StandbyChannelHandlers{[this](const StandbyMessage& message) {
                               const std::lock_guard lock(mutex_);
                               first_ = message.member;
                             },
                             [](const auto&) {}, [](const auto&) {}, [](const auto&) {}}};
};

// A database that ends each connection. Its thread counts them.
class LostDatabase {
 public:
  LostDatabase() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const bound = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listening_.get(), bound, size), 0);
    EXPECT_EQ(::listen(listening_.get(), 8), 0);
    EXPECT_EQ(::getsockname(listening_.get(), bound, &size), 0);
    address_ = "postgresql://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) +
               "/plant?sslmode=disable&gssencmode=disable";
    thread_ = std::thread([this] {
      for (; !ending_; (void)accept()) {
        pollfd source{listening_.get(), POLLIN, 0};
        (void)::poll(&source, 1, 10);
      }
    });
  }
  ~LostDatabase() {
    ending_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] int connections() const { return connections_; }

 private:
  bool accept() {
    const FileDescriptor client(::accept(listening_.get(), nullptr, nullptr));
    if (client.valid()) ++connections_;
    return client.valid();
  }
  FileDescriptor listening_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  std::string address_;
  std::atomic<int> connections_ = 0;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

struct MembershipTest : ::testing::Test {
  static BridgeSpec spec_of_first() {
    BridgeSpec spec;
    spec.name = "first";
    spec.dds = testing::loopback();
    spec.standby = StandbySpec{"g", 2};
    return spec;
  }
  static BusGuard::Handlers unheard() {
    BusGuard::Handlers handlers;
    handlers.announce = [](const BridgeClaims&) {};
    return handlers;
  }
  MembershipTest() {
    commands.open(link, nullptr);
    member.take_part();
  }
  ~MembershipTest() override {
    (void)member.leave();
    link.close(0ms, DdsLink::Leave::kHandOver);
    commands.close();
  }
  // The second member is ready and waits until the first one is master.
  void await_master() {
    ASSERT_TRUE(eventually([&] {
      second.tell(StandbyRole::kWaiting);
      return member.figures().master && second.first().role == StandbyRole::kMaster;
    }));
  }

  const BridgeSpec spec = spec_of_first();
  CommandAudit audit;
  CommandRouter router;
  AlarmTable alarms;
  InputRelay inputs;
  InterestRegistry interests{[](const std::string&) {}};
  DialInRegistry modules;
  program::Server program{program::Hooks{}, modules};
  MetricsTable figures;
  MasterLease lease;
  RoleThread roles;
  CommandService commands{router, audit, alarms, lease, roles};
  IoThread plans{"plans"};
  PublisherThread sinks;
  BusGuard guard{"first", unheard()};
  testing::Received received;
  DdsLink link{spec.dds, "first", received.handlers()};
  std::atomic<const char*> step = "";
  const BusSet::Uses uses{
      {sinks, link, nullptr, audit, commands, alarms, inputs, figures, lease, true},
      guard,
      router,
      interests,
      program,
      modules,
      plans,
      step};
  BusSet buses{uses, spec, false};
  std::atomic<bool> readers_came = false;
  Membership member{{link, guard, buses, commands, alarms, lease, roles, readers_came}, spec, {}};
  Second second;
};

TEST_F(MembershipTest, AMasterThatHandsOverBeforeItHasOpenedItsBusesReleasesThem) {
  await_master();
  ASSERT_EQ(member.hand_over(), std::nullopt);
  (void)member.follow_role(false);
  EXPECT_FALSE(member.is_serving());
  EXPECT_TRUE(eventually([&] {
    second.tell(StandbyRole::kWaiting);
    return second.first().role == StandbyRole::kReleased;
  }));
  EXPECT_EQ(second.first().successor, "second");
}

TEST_F(MembershipTest, AMasterThatStepsBackBeforeItHasOpenedItsBusesRestarts) {
  await_master();
  EXPECT_TRUE(eventually([&] {
    second.tell(StandbyRole::kMaster, StandbyTerm{9} << 32 | 1);
    return !member.figures().master;
  }));
  EXPECT_EQ(member.follow_role(false), Membership::Next::kRestart) << "or it is never ready again";
}

TEST_F(MembershipTest, ASecondRequestForAHandOverIsNotRefused) {
  await_master();
  (void)member.follow_role(false);
  ASSERT_TRUE(member.is_serving());
  EXPECT_EQ(member.hand_over(), std::nullopt);
  EXPECT_EQ(member.hand_over(), std::nullopt);
}

TEST_F(MembershipTest, AMasterThatHasSteppedBackIsReplacedBeforeItStops) {
  await_master();
  (void)member.follow_role(false);
  ASSERT_TRUE(member.is_serving());
  EXPECT_TRUE(eventually([&] {
    second.tell(StandbyRole::kMaster, StandbyTerm{9} << 32 | 1);
    return !member.figures().master;
  }));
  EXPECT_TRUE(member.hand_over_before_stop());
}

TEST_F(MembershipTest, AMasterThatStopsAfterItHasReleasedItsBusesWaitsForItsSuccessor) {
  await_master();
  (void)member.follow_role(false);
  ASSERT_EQ(member.hand_over(), std::nullopt);
  (void)member.follow_role(false);
  ASSERT_FALSE(member.is_serving());
  EXPECT_TRUE(member.is_pausing()) << "a reload waits";
  EXPECT_TRUE(member.needs_successor());
  auto replaced = std::async(std::launch::async, [&] { return member.hand_over_before_stop(); });
  EXPECT_EQ(replaced.wait_for(100ms), std::future_status::timeout);
  EXPECT_TRUE(eventually([&] {
    second.tell(StandbyRole::kMaster, StandbyTerm{9} << 32 | 1);
    return replaced.wait_for(10ms) == std::future_status::ready;
  }));
  EXPECT_TRUE(replaced.get());
}

// Each attempt may last for seconds, and the bridge cannot stop meanwhile.
TEST_F(MembershipTest, ADatabaseThatIsLostIsTriedOnceForAllBuses) {
  const LostDatabase database;
  BridgeSpec stored = spec;
  stored.store = StoreSpec{};
  stored.store->address = database.address();
  BusSet many{uses, stored, false};
  many.load_alarms({"one", "two", "three"});
  EXPECT_EQ(database.connections(), 1);
}

}  // namespace
}  // namespace fieldcast

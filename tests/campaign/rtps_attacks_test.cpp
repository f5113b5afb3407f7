// Attacks a real participant behind the guard, over UDP on the loopback. It must continue to
// receive samples, and its memory must not grow.
#include <gtest/gtest.h>

#include <atomic>
#include <cctype>

#include "tests/bridge/dds/dds_support.hpp"
#include "tests/bridge/dds/transport/known_attacks.hpp"
#include "tests/campaign/attacked_domain.hpp"

namespace fieldcast {
namespace {

using testing::AttackedDomain;
using testing::Datagram;
using testing::eventually;

constexpr double kMostGrowth = 64;  // megabytes

std::uint64_t refused_in_all() {
  std::uint64_t all = 0;
  for (const std::uint64_t count : refused_datagrams()) all += count;
  return all;
}

// One participant for all attacks of a suite.
class RtpsAttack : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    attacked = std::make_unique<AttackedDomain>(testing::loopback());
    ASSERT_TRUE(attacked->is_ready());
    ASSERT_NE(testing::samples_port(*attacked->reader), 0U);
  }
  static void TearDownTestSuite() { attacked.reset(); }

  static Datagram forged(const Datagram& one) {
    return testing::in_name_of(attacked->forged_sender(), attacked->forged_entity(),
                               attacked->reader_entity(), one);
  }
  // Sends each datagram to the sample port and to the discovery port.
  static void survives(const std::vector<Datagram>& attacks, bool are_refused) {
    const double memory = testing::resident_megabytes();
    const std::uint64_t refused = refused_in_all();
    const std::uint64_t expected = are_refused ? 2 * attacks.size() : 0;
    for (const Datagram& one : attacks) {
      attacked->send(forged(one), false);
      attacked->send(forged(one), true);
    }
    EXPECT_TRUE(eventually([&] { return refused_in_all() >= refused + expected; }));
    EXPECT_TRUE(attacked->answers());
    EXPECT_LT(testing::resident_megabytes() - memory, kMostGrowth);
    EXPECT_EQ(refused_in_all() - refused, expected);
  }

  static inline std::unique_ptr<AttackedDomain> attacked;
};

class KnownAttack : public RtpsAttack, public ::testing::WithParamInterface<testing::Attack> {};

TEST_P(KnownAttack, DoesNothing) { survives({GetParam().datagram}, true); }

std::string name_of(const ::testing::TestParamInfo<testing::Attack>& attack) {
  std::string name = attack.param.name;
  for (char& one : name)
    if (std::isalnum(static_cast<unsigned char>(one)) == 0) one = '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(Cve, KnownAttack, ::testing::ValuesIn(testing::known_attacks()), name_of);

TEST_F(RtpsAttack, AGapOverAMillionNumbers) {  // CVE-2025-64438
  survives({testing::heartbeat(1, 1'000'000, 1000), testing::gap(10, 1'000'000)}, false);
}

// CVE-2025-65016: each number up to the first one costs time. The writer is matched already.
TEST_F(RtpsAttack, AHeartbeatFarAhead) {
  constexpr std::int64_t kFar = std::int64_t{1} << 40;
  survives({testing::heartbeat(kFar, kFar + 1, 1000), testing::heartbeat(1, kFar, 1001)}, true);
}

// CVE-2026-49863, CVE-2026-22591: the guard drops these values before the library parses them.
TEST_F(RtpsAttack, DescriptionsWhoseLengthsAreNotThere) {
  std::vector<Datagram> all;
  for (const int id : {0x0035, 0x0069, 0x0072, 0x0075}) {
    all.push_back(testing::listing(kPublicationsWriter, static_cast<std::uint16_t>(id),
                                   testing::words({0xfffffff8, 0xffffffff, 0x7fffffff})));
  }
  survives(all, false);
}

// A short last fragment is legal: the library allocates more memory than the sample announces.
TEST_F(RtpsAttack, AFragmentOfOneByte) {
  std::vector<Datagram> all;
  for (std::int64_t number = 1'000'000; number < 1'000'100; ++number) {
    const auto rest = static_cast<std::uint32_t>(1 + number % 3);
    all.push_back(testing::data_frag(1, 1, 1024, 1024 + rest, 1024, 28, number));
    all.push_back(testing::data_frag(2, 1, 1024, 1024 + rest, rest, 28, number));
  }
  survives(all, false);
}

struct Discovered : DiscoveryListener {
  void on_participant(const FoundParticipant& found) override {
    if (found.name != "idle") return;
    is_there = !found.gone;
    if (found.gone) ++left;
  }
  std::atomic<bool> is_there{false};
  std::atomic<int> left{0};
};

// CVE-2026-45092: forged participants fill the table. The guard then removes one of our
// participants without endpoints; it returns when it announces itself again.
TEST(RtpsFlood, AParticipantThatMadeRoomReturns) {
  DdsSpec spec = testing::loopback();
  spec.max_participants = 4;
  Discovered discovered;
  Domain victim(spec, "victim", &discovered), idle(spec, "idle", nullptr);
  dds::DataReader* reader = victim.reader(kSampleTopic, nullptr, dds::StatusMask::none());
  ASSERT_TRUE(eventually([&] { return discovered.is_there.load(); }));
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ParticipantPrefix forged = testing::kSender;
  for (int i = 0; i < 20; ++i) {
    ++forged[11];
    testing::send_to(*reader, socket.get(), testing::announcement(forged), true);
  }
  EXPECT_TRUE(eventually([&] { return discovered.left > 0; }));
  EXPECT_TRUE(eventually([&] { return discovered.is_there.load(); }));
}

}  // namespace
}  // namespace fieldcast

// Attacks on a real participant behind the guard, over UDP on the loopback: it goes on to receive
// the samples of others, and its memory stays as it is.
#include <gtest/gtest.h>

#include "tests/bridge/dds/dds_support.hpp"
#include "tests/campaign/attacked_domain.hpp"
#include "tests/campaign/rtps_mutation.hpp"

namespace fieldcast {
namespace {

using testing::AttackedDomain;
using testing::Datagram;

constexpr double kMostGrowth = 64;  // megabytes

std::uint64_t refused_in_all() {
  std::uint64_t all = 0;
  for (const std::uint64_t count : refused_datagrams()) all += count;
  return all;
}

class RtpsAttack : public ::testing::Test {
 protected:
  // In the name of the matched writer, to its reader.
  Datagram forged(Datagram one) const {
    one = testing::from(attacked.forged_sender(), std::move(one));
    const auto replace = [&](const EntityBytes& from, const EntityBytes& to) {
      const auto at = std::search(one.begin(), one.end(), from.begin(), from.end());
      if (at != one.end()) std::copy(to.begin(), to.end(), at);
    };
    replace(testing::kSamplesReader, attacked.reader_entity());
    replace(testing::kSamplesWriter, attacked.forged_entity());
    return one;
  }
  void survives(const std::vector<Datagram>& attacks, bool are_refused) {
    ASSERT_TRUE(attacked.is_ready());
    ASSERT_NE(attacked.samples_port(), 0U);
    const double memory = testing::resident_megabytes();
    const std::uint64_t refused = refused_in_all();
    for (const Datagram& one : attacks) attacked.send(forged(one), false);
    if (are_refused) {
      EXPECT_TRUE(testing::eventually([&] { return refused_in_all() == refused + attacks.size(); }))
          << refused_in_all() - refused << " of " << attacks.size() << " were refused";
    }
    EXPECT_TRUE(attacked.answers());
    EXPECT_LT(testing::resident_megabytes() - memory, kMostGrowth);
    EXPECT_EQ(refused_in_all() - refused, are_refused ? attacks.size() : 0);
  }

  AttackedDomain attacked{testing::loopback()};
};

TEST_F(RtpsAttack, FragmentsThatDoNotFitTheirSample) {  // CVE-2025-62799, CVE-2026-22590, ..
  survives(
      {testing::data_frag(1, 1, 1, 9, 1), testing::data_frag(0, 1, 1024, 2048, 1024),
       testing::data_frag(0x400001, 1, 1024, 2048, 1024), testing::data_frag(2, 1, 1024, 2048, 16),
       testing::data_frag(1, 1, 60'000, 0xfffffff0, 60'000),
       testing::data_frag(1, 1, 1024, 2048, 1024, 0x7fff)},
      true);
}

TEST_F(RtpsAttack, AGapOverAMillionNumbers) {  // CVE-2025-64438
  survives({testing::heartbeat(1, 1'000'000, 1000), testing::gap(10, 1'000'000)}, false);
}

TEST_F(RtpsAttack, AHeartbeatFarAhead) {  // CVE-2025-65016
  constexpr std::int64_t kFar = std::int64_t{1} << 40;
  survives({testing::heartbeat(kFar, kFar + 1, 1000), testing::heartbeat(1, kFar, 1001)}, true);
}

TEST_F(RtpsAttack, ParametersWhoseCountsAreNotThere) {  // CVE-2025-62599, CVE-2026-49861, ..
  using testing::words;
  const auto listing = [](const EntityBytes& writer, std::uint16_t id, const Datagram& value) {
    return testing::discovery(writer, {{id, value}});
  };
  const Datagram token = testing::text("DDS:Auth:PKI-DH:1.0");
  Datagram properties = token, binaries = token;
  testing::put_all(properties, words({0x10000000, 0}));
  testing::put_all(binaries, words({0, 0x10000000}));
  survives({listing(kParticipantWriter, 0x1001, properties),
            listing(kParticipantWriter, 0x1002, binaries),
            listing(kParticipantWriter, 0x0059, words({0x80000000})),
            listing(kPublicationsWriter, 0x0073, words({0x80000000, 0})),
            listing(kPublicationsWriter, 0x0029, words({0xffffffff, 0xfffffffc, 0}))},
           true);
}

}  // namespace
}  // namespace fieldcast

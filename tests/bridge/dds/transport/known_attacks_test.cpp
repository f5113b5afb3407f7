// The known faults of Fast DDS (docs/security.md): a datagram for each, built by hand from its
// public description. The validator refuses each with the named cause; each changed back to what is
// right passes, so that nothing else in it is refused.
#include <gtest/gtest.h>

#include <vector>

#include "tests/bridge/dds/transport/rtps_datagrams.hpp"

namespace fieldcast {
namespace {

using testing::data_frag;
using testing::Datagram;
using testing::gap;
using testing::put_text;
using testing::put_u32;
using testing::words;

// DATA of discovery whose list is this one parameter.
Datagram listing(const EntityBytes& writer, std::uint16_t id, const Datagram& value,
                 std::uint16_t to_qos = 16, bool with_end = true) {
  return testing::discovery(writer, {{id, value}}, to_qos, with_end);
}
Datagram name_of_length(std::uint32_t length) {
  Datagram all;
  put_text(all, "a", length);
  return all;
}
Datagram token(std::uint32_t length_of_class, std::uint32_t properties, std::uint32_t binaries) {
  Datagram all;
  put_text(all, "DDS:Auth:PKI-DH:1.0", length_of_class);  // 20 with its end
  put_u32(all, properties);
  put_u32(all, binaries);
  return all;
}
Datagram property(std::uint32_t count, std::uint32_t length_of_value) {
  Datagram all;
  put_u32(all, count);
  put_text(all, "key", 4);
  put_text(all, "val", length_of_value);
  return all;
}

struct Attack {
  const char* name;
  RtpsFault fault;
  Datagram datagram;
  Datagram right;  // the same without the fault; empty: there is none
};

std::vector<Attack> known_attacks() {
  constexpr std::uint32_t kWraps = 0xfffffff8;
  const EntityBytes spdp = kParticipantWriter, sedp = kPublicationsWriter;
  return {
      {"CVE-2025-62799, fragments of 1 byte", RtpsFault::kFragment, data_frag(1, 1, 1, 9, 1),
       data_frag(1, 1, 1024, 2048, 1024)},
      {"CVE-2025-62799, fragment 0", RtpsFault::kFragment, data_frag(0, 1, 1024, 2048, 1024), {}},
      {"CVE-2025-62799, product wraps",
       RtpsFault::kFragment,
       data_frag(0x400001, 1, 1024, 2048, 1024),
       {}},
      {"CVE-2026-22590, short last fragment", RtpsFault::kFragment, data_frag(2, 1, 1024, 2048, 16),
       data_frag(2, 1, 1024, 2048, 1024)},
      {"DATA_FRAG of a sample of 4 GB",
       RtpsFault::kSampleSize,
       data_frag(1, 1, 60000, 0xfffffff0, 60000),
       {}},
      {"CVE-2025-65865, offset before the QoS",
       RtpsFault::kSubmessage,
       data_frag(1, 1, 1024, 2048, 1024, 0x7fff),
       {}},
      // Ranges below are for DatagramGuard: legal GAPs span what a slow channel leaves between.
      {"CVE-2025-64438, range of 2^50", RtpsFault::kSequenceNumber, gap(1, std::int64_t{1} << 50),
       gap(1, 2)},
      {"CVE-2023-39534, range runs backwards", RtpsFault::kSequenceNumber, gap(10, 5), {}},
      {"GAP of 257 bits", RtpsFault::kBitmap, gap(1, 2, 257), {}},
      {"CVE-2024-28231, offset behind the payload", RtpsFault::kSubmessage,
       listing(spdp, 0x0062, name_of_length(2), 0x7ff0), listing(spdp, 0x0062, name_of_length(2))},
      {"list without an end",
       RtpsFault::kParameterList,
       listing(spdp, 0x0062, name_of_length(2), 16, false),
       {}},
      {"name longer than the list",
       RtpsFault::kParameter,
       listing(spdp, 0x0062, name_of_length(kWraps)),
       {}},
      {"CVE-2023-39946, property longer than the list", RtpsFault::kParameter,
       listing(spdp, 0x0059, property(1, 4000)), listing(spdp, 0x0059, property(1, 4))},
      {"CVE-2026-53590, 2^31 properties",
       RtpsFault::kParameter,
       listing(spdp, 0x0059, property(0x80000000, 4)),
       {}},
      {"CVE-2025-62599, 2^28 properties of a token", RtpsFault::kParameter,
       listing(spdp, 0x1001, token(20, 0x10000000, 0)), listing(spdp, 0x1001, token(20, 0, 0))},
      {"CVE-2025-62600, 2^28 binary properties",
       RtpsFault::kParameter,
       listing(spdp, 0x1002, token(20, 0, 0x10000000)),
       {}},
      {"CVE-2025-62601, class that wraps",
       RtpsFault::kParameter,
       listing(spdp, 0x1001, token(kWraps, 0, 0)),
       {}},
      {"CVE-2026-49861, 2^31 data representations", RtpsFault::kParameter,
       listing(sedp, 0x0073, words({0x80000000, 0})), listing(sedp, 0x0073, words({1, 0}))},
      {"CVE-2026-55063, partition without an end", RtpsFault::kParameter,
       listing(sedp, 0x0029, words({1, 4, 0x61616161})),
       listing(sedp, 0x0029, words({1, 4, 0x00616161}))},
      {"GHSA-8g7x-c9fg-g6mh, partition that wraps",
       RtpsFault::kParameter,
       listing(sedp, 0x0029, words({0xffffffff, 0xfffffffc, 0})),
       {}},
  };
}

TEST(KnownAttacks, TheValidatorRefusesEachWithItsCause) {
  for (const Attack& attack : known_attacks()) {
    const auto fault = fault_of(attack.datagram, RtpsLimits{});
    ASSERT_TRUE(fault.has_value()) << attack.name;
    EXPECT_EQ(to_text(*fault), to_text(attack.fault)) << attack.name;
  }
}

TEST(KnownAttacks, WithoutTheFaultEachIsTaken) {
  for (const Attack& attack : known_attacks()) {
    if (attack.right.empty()) continue;
    const auto fault = fault_of(attack.right, RtpsLimits{});
    EXPECT_FALSE(fault.has_value()) << attack.name << ": " << to_text(fault.value_or(RtpsFault{}));
  }
}

}  // namespace
}  // namespace fieldcast

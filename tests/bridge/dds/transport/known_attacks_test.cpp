// The known faults of Fast DDS (docs/security.md): a datagram for each, built by hand from its
// public description. The validator refuses each with the named cause; each changed back to what is
// right passes, so that nothing else in it is refused.
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "bridge/dds/transport/rtps_validator.hpp"

namespace fieldcast {
namespace {

using Datagram = std::vector<std::uint8_t>;

void put(Datagram& to, std::initializer_list<std::uint8_t> bytes) { to.insert(to.end(), bytes); }
void put_u16(Datagram& to, std::uint32_t value) {
  for (int i = 0; i < 2; ++i) to.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}
void put_u32(Datagram& to, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}
void put_number(Datagram& to, std::int64_t number) {  // high, then low
  put_u32(to, static_cast<std::uint32_t>(number >> 32));
  put_u32(to, static_cast<std::uint32_t>(number));
}
void put_text(Datagram& to, const std::string& text, std::uint32_t length) {
  put_u32(to, length);
  to.insert(to.end(), text.begin(), text.end());
  to.push_back(0);
  while (to.size() % 4 != 0) to.push_back(0);
}

// One submessage, little-endian, in a message of RTPS 2.2.
Datagram of_submessage(std::uint8_t kind, std::uint8_t flags, const Datagram& body) {
  Datagram all{'R', 'T', 'P', 'S', 2, 2, 1, 15, 0x91, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  put(all, {kind, flags});
  put_u16(all, static_cast<std::uint32_t>(body.size()));
  all.insert(all.end(), body.begin(), body.end());
  return all;
}

Datagram data_frag(std::uint32_t start, std::uint16_t count, std::uint16_t size,
                   std::uint32_t sample, std::size_t payload, std::uint16_t to_qos = 28) {
  Datagram body;
  put_u16(body, 0);                     // extra flags
  put_u16(body, to_qos);                // octets to inline QoS
  put(body, {0, 0, 1, 4, 0, 0, 1, 3});  // reader, writer
  put_number(body, 1);
  put_u32(body, start);   // first fragment
  put_u16(body, count);   // fragments here
  put_u16(body, size);    // bytes of a fragment
  put_u32(body, sample);  // bytes of the sample
  body.resize(body.size() + payload, 0);
  return of_submessage(0x16, 0x01, body);
}

Datagram gap(std::int64_t start, std::int64_t base, std::uint32_t bits = 0) {
  Datagram body;
  put(body, {0, 0, 1, 4, 0, 0, 1, 3});
  put_number(body, start);
  put_number(body, base);
  put_u32(body, bits);
  return of_submessage(0x08, 0x01, body);
}

// DATA of a writer with a parameter list as its payload.
Datagram discovery(EntityBytes writer, std::uint16_t id, const Datagram& value,
                   std::uint16_t to_qos = 16, bool with_end = true) {
  Datagram body;
  put_u16(body, 0);
  put_u16(body, to_qos);
  put(body, {0, 0, 0, 0});
  body.insert(body.end(), writer.begin(), writer.end());
  put_number(body, 1);
  put(body, {0, 3, 0, 0});  // PL_CDR, little-endian
  put_u16(body, id);
  put_u16(body, static_cast<std::uint32_t>(value.size()));
  body.insert(body.end(), value.begin(), value.end());
  if (with_end) put(body, {1, 0, 0, 0});
  return of_submessage(0x15, 0x05, body);
}

Datagram words(std::initializer_list<std::uint32_t> values) {
  Datagram all;
  for (const std::uint32_t value : values) put_u32(all, value);
  return all;
}
Datagram text(const std::string& value, std::uint32_t length) {
  Datagram all;
  put_text(all, value, length);
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
      {"CVE-2025-64438, range of 2^50", RtpsFault::kSequenceNumber,
       gap(1, std::int64_t{1} << 50), gap(1, 2)},
      {"CVE-2023-39534, range runs backwards", RtpsFault::kSequenceNumber, gap(10, 5), {}},
      {"GAP of 257 bits", RtpsFault::kBitmap, gap(1, 2, 257), {}},
      {"CVE-2024-28231, offset behind the payload", RtpsFault::kSubmessage,
       discovery(spdp, 0x0062, text("a", 2), 0x7ff0), discovery(spdp, 0x0062, text("a", 2))},
      {"list without an end",
       RtpsFault::kParameterList,
       discovery(spdp, 0x0062, text("a", 2), 16, false),
       {}},
      {"name longer than the list",
       RtpsFault::kParameter,
       discovery(spdp, 0x0062, text("a", kWraps)),
       {}},
      {"CVE-2023-39946, property longer than the list", RtpsFault::kParameter,
       discovery(spdp, 0x0059, property(1, 4000)), discovery(spdp, 0x0059, property(1, 4))},
      {"CVE-2026-53590, 2^31 properties",
       RtpsFault::kParameter,
       discovery(spdp, 0x0059, property(0x80000000, 4)),
       {}},
      {"CVE-2025-62599, 2^28 properties of a token", RtpsFault::kParameter,
       discovery(spdp, 0x1001, token(20, 0x10000000, 0)), discovery(spdp, 0x1001, token(20, 0, 0))},
      {"CVE-2025-62600, 2^28 binary properties",
       RtpsFault::kParameter,
       discovery(spdp, 0x1002, token(20, 0, 0x10000000)),
       {}},
      {"CVE-2025-62601, class that wraps",
       RtpsFault::kParameter,
       discovery(spdp, 0x1001, token(kWraps, 0, 0)),
       {}},
      {"CVE-2026-49861, 2^31 data representations", RtpsFault::kParameter,
       discovery(sedp, 0x0073, words({0x80000000, 0})), discovery(sedp, 0x0073, words({1, 0}))},
      {"CVE-2026-55063, partition without an end", RtpsFault::kParameter,
       discovery(sedp, 0x0029, words({1, 4, 0x61616161})),
       discovery(sedp, 0x0029, words({1, 4, 0x00616161}))},
      {"GHSA-8g7x-c9fg-g6mh, partition that wraps",
       RtpsFault::kParameter,
       discovery(sedp, 0x0029, words({0xffffffff, 0xfffffffc, 0})),
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

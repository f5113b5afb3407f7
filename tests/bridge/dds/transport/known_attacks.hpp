// A datagram for each known fault of Fast DDS (docs/security.md), built by hand from its public
// description.
#pragma once

#include <algorithm>
#include <vector>

#include "tests/bridge/dds/transport/rtps_datagrams.hpp"

namespace fieldcast::testing {

// Discovery DATA with this parameter behind the GUID, which the library reads first.
inline Datagram listing(const EntityBytes& writer, std::uint16_t id, const Datagram& value,
                        std::uint16_t to_qos = 16, bool with_end = true) {
  const bool is_participant = writer == kParticipantWriter;
  const Parameter guid{static_cast<std::uint16_t>(is_participant ? 0x0050 : 0x005a),
                       guid_of(kSender, is_participant ? kParticipant : EntityBytes{0, 9, 9, 3})};
  return discovery(writer, {guid, {id, value}}, to_qos, with_end);
}
inline Datagram name_of_length(std::uint32_t length) {
  Datagram all;
  put_text(all, "a", length);
  return all;
}
inline Datagram token(std::uint32_t length_of_class, std::uint32_t properties,
                      std::uint32_t binaries) {
  Datagram all;
  put_text(all, "DDS:Auth:PKI-DH:1.0", length_of_class);  // 20 with the terminating zero
  put_u32(all, properties);
  put_u32(all, binaries);
  return all;
}
inline Datagram property(std::uint32_t count, std::uint32_t length_of_value) {
  Datagram all;
  put_u32(all, count);
  put_text(all, "key", 4);
  put_text(all, "val", length_of_value);
  return all;
}

// A handshake with this many holders; the first holder has this many properties.
inline Datagram handshake_of(std::uint32_t holders, std::uint32_t properties) {
  Datagram content(2 * 24 + 3 * 16, 0);
  put_text(content, "dds.sec.auth", 13);
  put_u32(content, holders);
  put_text(content, "DDS:Auth:PKI-DH:1.0+Req", 24);
  put_all(content, words({properties, 0}));
  return data({0, 2, 1, 0xc3}, 1, {}, payload_of(1, content));
}
// A token with one binary property whose value has this length.
inline Datagram binary_of_length(std::uint32_t length) {
  Datagram all;
  put_text(all, "DDS:Auth:PKI-DH:1.0", 20);
  put_all(all, words({0, 1}));
  put_text(all, "c.id", 5);
  put_u32(all, length);
  put_u32(all, 0);
  return all;
}
// A protected message with this length of its bytes, big-endian with any flag.
inline Datagram protected_of_length(std::uint32_t length) {
  Datagram all = of_submessage(0x33, 1, Datagram(20, 0)), body;
  for (int i = 3; i >= 0; --i) body.push_back(static_cast<std::uint8_t>(length >> 8 * i));
  body.resize(4 + 32, 0x55);
  put_submessage(all, 0x30, 1, body);
  put_submessage(all, 0x34, 1, Datagram(20, 0));
  return all;
}

struct Attack {
  const char* name;
  RtpsFault fault;
  Datagram datagram;
  Datagram right;  // the same without the fault; empty if none exists
};

inline std::vector<Attack> known_attacks() {
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
      // Shorter ranges are checked by DatagramGuard: slow channels cause long legal GAPs.
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
      {"CVE-2023-39945, encapsulation that does not exist", RtpsFault::kEncapsulation,
       data(kSamplesWriter, 1, {}, payload_of(0x40, Datagram(16, 0))), sample(1)},
      {"CVE-2023-39948, encapsulation of a request for a type",
       RtpsFault::kService,
       data({0, 3, 0, 0xc3}, 1, {}, payload_of(1, Datagram(16, 0))),
       {}},
      {"CVE-2023-39949, numbers that run backwards", RtpsFault::kSequenceNumber, heartbeat(9, 7, 1),
       heartbeat(7, 9, 1)},
      {"CVE-2023-42459, payload of 2 bytes", RtpsFault::kEncapsulation,
       data(kSamplesWriter, 1, {}, {0, 1}), sample(1)},
      {"CVE-2023-50716, fragment without a payload", RtpsFault::kFragment,
       data_frag(1, 1, 1024, 2048, 0), data_frag(1, 1, 1024, 2048, 1024)},
      {"CVE-2024-30258, 2^16 properties of a token", RtpsFault::kParameter,
       listing(spdp, 0x1001, token(20, 0x10000, 0)), listing(spdp, 0x1001, token(20, 0, 0))},
      {"CVE-2024-30259, 2^16 binary properties of a token", RtpsFault::kParameter,
       listing(spdp, 0x1002, token(20, 0, 0x10000)), listing(spdp, 0x1002, token(20, 0, 0))},
      {"CVE-2025-62602, length of a binary property that wraps", RtpsFault::kParameter,
       listing(spdp, 0x1001, binary_of_length(kWraps)), listing(spdp, 0x1001, binary_of_length(4))},
      {"CVE-2025-62603, 2^32 holders of a handshake", RtpsFault::kParameter,
       handshake_of(0xffffffff, 0), handshake_of(1, 0)},
      {"CVE-2025-62603, 2^32 properties of a handshake", RtpsFault::kParameter,
       handshake_of(1, 0xffffffff), handshake_of(1, 0)},
      {"CVE-2025-64098, class of a token that is longer than the list", RtpsFault::kParameter,
       listing(spdp, 0x1002, token(4000, 0, 0)), listing(spdp, 0x1002, token(20, 0, 0))},
      {"CVE-2025-65016, first number above 2^36",
       RtpsFault::kSequenceNumber,
       heartbeat(std::int64_t{1} << 50, std::int64_t{1} << 50, 1000),
       {}},
      {"CVE-2026-22591, content filter in inline QoS", RtpsFault::kParameter,
       data(kSamplesWriter, 1, list_of({{0x0035, words({0, 0})}}), payload_of(1, {})),
       data(kSamplesWriter, 1, list_of({{0x0055, words({0, 0})}}), payload_of(1, {}))},
      {"CVE-2026-45098, protected bytes that are longer than their submessage",
       RtpsFault::kSubmessage, protected_of_length(0xfffffff0), protected_of_length(32)},
      {"CVE-2026-53589, reliability of 4 bytes", RtpsFault::kParameter,
       listing(sedp, 0x001a, words({2})), listing(sedp, 0x001a, words({2, 0, 100}))},
      {"GHSA-8g7x-c9fg-g6mh, partition that wraps",
       RtpsFault::kParameter,
       listing(sedp, 0x0029, words({0xffffffff, 0xfffffffc, 0})),
       {}},
  };
}

// Rewrites the attack in the name of a matched writer, to its reader, with a number above all
// received ones; the reader ignores lower numbers.
inline Datagram in_name_of(const ParticipantPrefix& sender, const EntityBytes& writer,
                           const EntityBytes& reader, Datagram attack) {
  const auto replace = [&](const auto& from, const auto& to) {
    for (auto at = attack.begin();;) {
      at = std::search(at, attack.end(), from.begin(), from.end());
      if (at == attack.end()) return;
      at = std::copy(to.begin(), to.end(), at);
    }
  };
  replace(kSender, sender);  // in GUIDs too
  replace(kSamplesReader, reader);
  replace(kSamplesWriter, writer);
  constexpr std::size_t kNumberAt = kMessageHeader + kSubmessageHeader + 16;  // its lower half
  const auto kind = static_cast<Submessage>(attack[kMessageHeader]);
  if (kind == Submessage::kData || kind == Submessage::kDataFrag) attack[kNumberAt + 1] |= 4;
  return attack;
}

}  // namespace fieldcast::testing

#include "bridge/dds/guard/rtps_validator.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/bridge/dds/transport/known_attacks.hpp"
#include "tests/bridge/dds/transport/recorded_datagrams.hpp"

namespace fieldcast {
namespace {

using testing::Attack;
using testing::known_attacks;

using namespace testing;  // NOLINT(google-build-using-namespace): parts of datagrams

std::string cause_of(const Datagram& datagram, const RtpsLimits& limits = {}) {
  const auto fault = fault_of(datagram, limits);
  return fault ? std::string(to_text(*fault)) : "none";
}
Datagram with(Datagram datagram, std::size_t at, std::uint8_t value) {
  datagram.at(at) = value;
  return datagram;
}
Datagram source_of(const ParticipantPrefix& prefix, std::size_t size = 20) {
  Datagram body = words({0, 0});
  put_all(body, prefix);
  body.resize(size, 0);
  return body;
}
Datagram signed_with(const Datagram& source) {
  Datagram all = of_submessage(0x33, 1, Datagram(20, 1));
  put_submessage(all, 0x0c, 1, source);
  put_submessage(all, 0x34, 1, Datagram(20, 0));
  return all;
}

TEST(RtpsValidator, TakesOneOfEachForm) {
  for (const NamedDatagram& one : valid_datagrams())
    EXPECT_EQ(cause_of(one.bytes), "none") << one.name;
}

TEST(RtpsValidator, NamesTheCause) {
  const Datagram one = sample(1);
  EXPECT_EQ(cause_of({}), "HEADER");
  EXPECT_EQ(cause_of(with(one, 0, 'X')), "HEADER");
  EXPECT_EQ(cause_of(with(one, 4, 1)), "HEADER") << "RTPS 1";
  EXPECT_EQ(cause_of(with(one, 22, 0xff)), "SUBMESSAGE") << "longer than the datagram";
  EXPECT_EQ(cause_of(with(one, 26, 20)), "SUBMESSAGE") << "an offset into the payload";
  EXPECT_EQ(cause_of(with(one, 21, 0x0d)), "SUBMESSAGE") << "data and key";
  EXPECT_EQ(cause_of(of_submessage(0x0f, 1, Datagram(24, 0))), "ORDER") << "answers elsewhere";
  EXPECT_EQ(cause_of(of_submessage(0x32, 1, Datagram(20, 0))), "ORDER") << "an end first";
  EXPECT_EQ(cause_of(of_submessage(0x31, 1, Datagram(20, 0))), "ORDER") << "no end";
  EXPECT_EQ(cause_of(sample(0)), "SEQUENCE_NUMBER");
  EXPECT_EQ(cause_of(sample(-5)), "SEQUENCE_NUMBER");
  EXPECT_EQ(cause_of(heartbeat(9, 7, 1)), "SEQUENCE_NUMBER");
  EXPECT_EQ(cause_of(heartbeat(std::int64_t{1} << 50, std::int64_t{1} << 50, 1)),
            "SEQUENCE_NUMBER");
  EXPECT_EQ(cause_of(gap(1, 2, 32)), "BITMAP") << "bits that are not there";
  EXPECT_EQ(cause_of(data_frag(3, 1, 1024, 2048, 1024)), "FRAGMENT") << "behind the last one";
  EXPECT_EQ(cause_of(data_frag(1, 1, 1024, 2048, 1020)), "FRAGMENT") << "too few bytes";
  EXPECT_EQ(cause_of(nack_frag(1, 0, 1)), "FRAGMENT");
  EXPECT_EQ(cause_of(data_frag(1, 1, 1024, 1 << 21, 1024)), "SAMPLE_SIZE");
  EXPECT_EQ(cause_of(data_frag(1, 1, 1024, 1 << 21, 1024), {.sample_bytes = 1 << 21}), "none");
  EXPECT_EQ(cause_of(discovery(kParticipantWriter, {}, 16, false)), "PARAMETER_LIST");
  EXPECT_EQ(cause_of(discovery(kParticipantWriter, {{0x0062, Datagram(6, 0)}})), "PARAMETER_LIST");
  EXPECT_EQ(cause_of(discovery(kParticipantWriter, {{0x0058, Datagram(8, 0)}})), "PARAMETER");
  EXPECT_EQ(cause_of(discovery(kParticipantWriter, {{0x0002, words({0x80000000, 0})}})),
            "PARAMETER")
      << "a negative lease";
  EXPECT_EQ(cause_of(data(kSamplesWriter, 1, {}, payload_of(0x40, {}))), "ENCAPSULATION");
  EXPECT_EQ(cause_of(data(kParticipantWriter, 1, {}, payload_of(1, list_of({})))), "ENCAPSULATION");
  EXPECT_EQ(cause_of(data({0, 3, 0, 0xc3}, 1, {}, payload_of(1, {}))), "SERVICE")
      << "a request for the description of a type";
}

TEST(RtpsValidator, TooManySubmessagesAreAFault) {
  Datagram many = header();
  for (int i = 0; i < 2048; ++i) put_submessage(many, 0x01, 1, {});
  EXPECT_EQ(cause_of(many), "none");
  put_submessage(many, 0x01, 1, {});
  EXPECT_EQ(cause_of(many), "ORDER");
}

// DDS Security repeats the sender in a signed message; elsewhere a second sender is forged.
TEST(RtpsValidator, ASourceIsTakenInASignedMessageOfThatSenderAlone) {
  EXPECT_EQ(cause_of(signed_with(source_of(kSender))), "none");
  ParticipantPrefix other = kSender;
  other[11] ^= 1;
  EXPECT_EQ(cause_of(signed_with(source_of(other))), "ORDER");
  EXPECT_EQ(cause_of(signed_with(source_of(kSender, 24))), "ORDER");
  EXPECT_EQ(cause_of(of_submessage(0x0c, 1, source_of(kSender))), "ORDER") << "not signed";
}

// A participant announces only its own endpoints; a discovery server relays those of others.
TEST(RtpsValidator, AnAnnouncementOfAnotherIsTakenFromAServerAlone) {
  ParticipantPrefix other = kSender;
  other[11] ^= 1;
  for (const Datagram& one : {announcement(other), endpoint(1, other), goodbye(other)}) {
    EXPECT_EQ(cause_of(one), "none");
    EXPECT_EQ(cause_of(from(kSender, one)), "PARAMETER");
    EXPECT_EQ(cause_of(from(kSender, one), {.relayed = true}), "none");
  }
}

// The library would parse a content filter in inline QoS; only its description is allowed.
TEST(RtpsValidator, AContentFilterInInlineQosIsAFault) {
  const auto with_qos = [](std::uint16_t id) {
    return data(kSamplesWriter, 1, list_of({{id, words({0, 0})}}), payload_of(1, {}));
  };
  EXPECT_EQ(cause_of(with_qos(0x0035)), "PARAMETER");
  EXPECT_EQ(cause_of(with_qos(0x0055)), "none");
}

// Found by the campaign: the library aborts the process by an assertion.
TEST(RtpsValidator, CountsOfFastDdsAreTheLastSubmessage) {
  const Datagram counts = of_submessage(0x80, 1, Datagram(56, 0));
  EXPECT_EQ(cause_of(joined(heartbeat(1, 2, 1), counts)), "none");
  EXPECT_EQ(cause_of(joined(counts, heartbeat(1, 2, 1))), "ORDER");
}

TEST(RtpsValidator, TakesTheRecordedTrafficOfCycloneDds) {
  const std::vector<Datagram> recorded = recorded_datagrams();
  EXPECT_GT(recorded.size(), 40U);
  for (std::size_t i = 0; i < recorded.size(); ++i) EXPECT_EQ(cause_of(recorded[i]), "none") << i;
}

// Calls with each datagram in memory of exactly its size, so that AddressSanitizer detects each
// read behind it.
template <class Change>
void each_is_taken_or_refused(Change change) {
  std::size_t taken = 0, refused = 0;
  std::vector<Datagram> corpus = recorded_datagrams();
  for (const NamedDatagram& one : valid_datagrams()) corpus.push_back(one.bytes);
  for (const Datagram& one : corpus) {
    change(one, [&](const Datagram& changed) {
      const auto exact = std::make_unique<std::uint8_t[]>(changed.size());
      std::copy(changed.begin(), changed.end(), exact.get());
      const auto fault = fault_of({exact.get(), changed.size()}, RtpsLimits{});
      ++(fault ? refused : taken);
      EXPECT_NE(fault ? to_text(*fault) : "none", "UNKNOWN");
    });
  }
  EXPECT_GT(taken, 0U);
  EXPECT_GT(refused, 0U);
}

TEST(RtpsValidator, EveryTruncationIsTakenOrRefused) {
  each_is_taken_or_refused([](const Datagram& whole, const auto& check) {
    for (std::size_t size = 0; size <= whole.size(); ++size)
      check(Datagram(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
  });
}

TEST(RtpsValidator, EveryFlippedBitIsTakenOrRefused) {
  each_is_taken_or_refused([](Datagram bytes, const auto& check) {
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      const auto mask = static_cast<std::uint8_t>(1U << bit % 8);
      bytes[bit / 8] ^= mask;
      check(bytes);
      bytes[bit / 8] ^= mask;
    }
  });
}

// Tests that the validator refuses each known attack with the named cause. The same datagram
// without the fault must pass, so that no other part of it is refused.

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

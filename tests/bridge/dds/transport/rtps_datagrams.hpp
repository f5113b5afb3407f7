// Handmade RTPS 2.2 datagrams for the tests and the bench of the guard: parts, and one valid
// datagram of each form. All are little-endian.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "bridge/dds/guard/rtps_validator.hpp"

namespace fieldcast::testing {

using Datagram = std::vector<std::uint8_t>;

inline void put(Datagram& to, std::initializer_list<std::uint8_t> bytes) {
  to.insert(to.end(), bytes);
}
template <class Range>
void put_all(Datagram& to, const Range& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}
inline void put_u16(Datagram& to, std::uint32_t value) {
  for (int i = 0; i < 2; ++i) to.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}
inline void put_u32(Datagram& to, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}
inline void put_number(Datagram& to, std::int64_t number) {  // high, then low
  put_u32(to, static_cast<std::uint32_t>(number >> 32));
  put_u32(to, static_cast<std::uint32_t>(number));
}
inline void put_text(Datagram& to, const std::string& text, std::uint32_t length) {
  put_u32(to, length);
  put_all(to, text);
  to.push_back(0);
  while (to.size() % 4 != 0) to.push_back(0);
}
inline Datagram words(std::initializer_list<std::uint32_t> values) {
  Datagram all;
  for (const std::uint32_t value : values) put_u32(all, value);
  return all;
}
inline Datagram text(const std::string& value) {
  Datagram all;
  put_text(all, value, static_cast<std::uint32_t>(value.size() + 1));
  return all;
}

inline constexpr ParticipantPrefix kSender{1, 15, 0x91, 2, 3, 4, 5, 6, 7, 8, 9, 10};
inline constexpr EntityBytes kSamplesReader{0, 0, 1, 4}, kSamplesWriter{0, 0, 1, 3};

inline Datagram header(const ParticipantPrefix& sender = kSender) {
  Datagram all{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  put_all(all, sender);
  return all;
}
inline void put_submessage(Datagram& to, std::uint8_t kind, std::uint8_t flags,
                           const Datagram& body) {
  put(to, {kind, flags});
  put_u16(to, static_cast<std::uint32_t>(body.size()));
  put_all(to, body);
}
inline Datagram of_submessage(std::uint8_t kind, std::uint8_t flags, const Datagram& body,
                              const ParticipantPrefix& sender = kSender) {
  Datagram all = header(sender);
  put_submessage(all, kind, flags, body);
  return all;
}
// Appends `second` without its header to `first`.
inline Datagram joined(Datagram first, const Datagram& second) {
  first.insert(first.end(), second.begin() + kMessageHeader, second.end());
  return first;
}
inline Datagram from(const ParticipantPrefix& sender, Datagram datagram) {
  std::copy(sender.begin(), sender.end(), datagram.begin() + 8);
  return datagram;
}

inline void put_entities(Datagram& to, const EntityBytes& reader, const EntityBytes& writer) {
  put_all(to, reader);
  put_all(to, writer);
}
inline Datagram data_frag(std::uint32_t start, std::uint16_t count, std::uint16_t size,
                          std::uint32_t sample, std::size_t payload, std::uint16_t to_qos = 28,
                          std::int64_t number = 1, std::uint8_t flags = 1) {
  Datagram body;
  put_u16(body, 0);  // extra flags
  put_u16(body, to_qos);
  put_entities(body, kSamplesReader, kSamplesWriter);
  put_number(body, number);
  put_u32(body, start);
  put_u16(body, count);
  put_u16(body, size);
  put_u32(body, sample);
  body.resize(body.size() + payload, 0);
  return of_submessage(0x16, flags, body);
}
inline Datagram gap(std::int64_t start, std::int64_t base, std::uint32_t bits = 0) {
  Datagram body;
  put_entities(body, kSamplesReader, kSamplesWriter);
  put_number(body, start);
  put_number(body, base);
  put_u32(body, bits);
  return of_submessage(0x08, 1, body);
}
inline Datagram heartbeat(std::int64_t first, std::int64_t last, std::uint32_t count) {
  Datagram body;
  put_entities(body, kSamplesReader, kSamplesWriter);
  put_number(body, first);
  put_number(body, last);
  put_u32(body, count);
  return of_submessage(0x07, 1, body);
}
inline Datagram acknack(std::int64_t base, std::initializer_list<std::uint32_t> missing,
                        std::uint32_t count = 1) {
  Datagram body;
  put_entities(body, kSamplesReader, kSamplesWriter);
  put_number(body, base);
  put_u32(body, static_cast<std::uint32_t>(32 * missing.size()));
  put_all(body, words(missing));
  put_u32(body, count);
  return of_submessage(0x06, 1, body);
}
inline Datagram nack_frag(std::int64_t number, std::uint32_t base, std::uint32_t missing) {
  Datagram body;
  put_entities(body, kSamplesReader, kSamplesWriter);
  put_number(body, number);
  put_all(body, words({base, 32, missing, 1}));
  return of_submessage(0x12, 1, body);
}
inline Datagram heartbeat_frag(std::int64_t number, std::uint32_t last) {
  Datagram body;
  put_entities(body, kSamplesReader, kSamplesWriter);
  put_number(body, number);
  put_all(body, words({last, 1}));
  return of_submessage(0x13, 1, body);
}

struct Parameter {
  std::uint16_t id;
  Datagram value;
};
using Parameters = std::vector<Parameter>;

inline Datagram list_of(const Parameters& parameters, bool with_end = true) {
  Datagram all;
  for (const Parameter& one : parameters) {
    put_u16(all, one.id);
    put_u16(all, static_cast<std::uint32_t>(one.value.size()));
    put_all(all, one.value);
  }
  if (with_end) put(all, {1, 0, 0, 0});
  return all;
}
// DATA: flags 1 little-endian, 2 inline QoS, 4 a payload, 8 a key.
inline Datagram data(const EntityBytes& writer, std::int64_t number, const Datagram& inline_qos,
                     const Datagram& payload, std::uint16_t to_qos = 16, std::uint8_t more = 0) {
  Datagram body;
  put_u16(body, 0);
  put_u16(body, to_qos);
  put_entities(body, {}, writer);
  put_number(body, number);
  put_all(body, inline_qos);
  put_all(body, payload);
  const int flags = 1 | (inline_qos.empty() ? 0 : 2) | (payload.empty() ? 0 : 4) | more;
  return of_submessage(0x15, static_cast<std::uint8_t>(flags), body);
}
inline Datagram payload_of(std::uint8_t encapsulation, const Datagram& content) {
  Datagram all{0, encapsulation, 0, 0};
  put_all(all, content);
  return all;
}
inline Datagram sample(std::int64_t number, std::size_t size = 400) {
  return data(kSamplesWriter, number, {}, payload_of(1, Datagram(size, 0x42)));
}
inline Datagram discovery(const EntityBytes& writer, const Parameters& parameters,
                          std::uint16_t to_qos = 16, bool with_end = true) {
  return data(writer, 1, {}, payload_of(3, list_of(parameters, with_end)), to_qos);
}

inline Datagram guid_of(const ParticipantPrefix& prefix, const EntityBytes& entity) {
  Datagram all(prefix.begin(), prefix.end());
  put_all(all, entity);
  return all;
}
// Port of announced locators, so that a real participant sends to no port of another domain.
inline constexpr std::uint32_t kNoPort = 9;
inline Datagram locator(std::uint32_t port) {
  Datagram all = words({1, port, 0, 0, 0});
  put(all, {127, 0, 0, 1});
  return all;
}
inline Datagram property_list(const std::string& key, const std::string& value) {
  Datagram all = words({1});
  put_text(all, key, static_cast<std::uint32_t>(key.size() + 1));
  put_text(all, value, static_cast<std::uint32_t>(value.size() + 1));
  return all;
}
inline constexpr EntityBytes kParticipant{0, 0, 1, 0xc1};

// Announcement of a participant, as Fast DDS 2.9.1 sends it.
inline Datagram announcement(const ParticipantPrefix& prefix = kSender) {
  return from(prefix, discovery(kParticipantWriter,
                                {{0x0015, {2, 2, 0, 0}},
                                 {0x0016, {1, 15, 0, 0}},
                                 {0x0050, guid_of(prefix, kParticipant)},
                                 {0x0033, locator(kNoPort)},
                                 {0x0032, locator(kNoPort)},
                                 {0x0031, locator(kNoPort)},
                                 {0x0002, words({20, 0})},
                                 {0x0058, words({0xc3f})},
                                 {0x0062, text("fieldcast-bridge one")},
                                 {0x0059, property_list("PARTICIPANT_TYPE", "SIMPLE")}}));
}
// Announcement of a writer of the participant, with a description of the type.
inline Datagram endpoint(std::uint32_t number, const ParticipantPrefix& prefix = kSender) {
  const EntityBytes entity{static_cast<std::uint8_t>(number >> 16),
                           static_cast<std::uint8_t>(number >> 8),
                           static_cast<std::uint8_t>(number), 3};
  return from(prefix, discovery(kPublicationsWriter, {{0x002f, locator(kNoPort)},
                                                      {0x0050, guid_of(prefix, kParticipant)},
                                                      {0x005a, guid_of(prefix, entity)},
                                                      {0x0005, text("fieldcast/SampleBlock")},
                                                      {0x0007, text("fieldcast::SampleBlock")},
                                                      {0x0075, Datagram(64, 1)},
                                                      {0x001d, words({1})},
                                                      {0x001a, words({2, 0, 100})},
                                                      {0x0029, words({1, 4, 0x00656e6f})}}));
}
inline Datagram goodbye(const ParticipantPrefix& prefix) {
  return from(prefix,
              data(kParticipantWriter, 2,
                   list_of({{0x0070, guid_of(prefix, kParticipant)}, {0x0071, {0, 0, 0, 3}}}), {}));
}

struct NamedDatagram {
  const char* name;
  Datagram bytes;
};

// Returns one datagram of each form that Fast DDS 2.9.1 and Cyclone DDS 0.10 send.
inline std::vector<NamedDatagram> valid_datagrams() {
  Datagram token;
  put_text(token, "DDS:Auth:PKI-DH:1.0+Req", 24);
  put_all(token, property_list("c.dsign_algo", "ECDSA-SHA256"));
  Datagram handshake(2 * 24 + 3 * 16, 7);
  put_text(handshake, "dds.sec.auth", 13);
  put_u32(handshake, 1);
  put_all(handshake, token);
  Datagram liveliness = guid_of(kSender, {0, 0, 0, 1});
  put_all(liveliness, words({1, 0}));

  Datagram body{0, 0, 0, 16};  // length of the protected part, big-endian
  body.resize(20, 0x5a);
  Datagram postfix(16, 0x33);
  put_all(postfix, words({0}));
  Datagram source = words({0});
  put(source, {2, 2, 1, 15});
  put_all(source, kSender);
  Datagram secured = of_submessage(0x31, 1, Datagram(20, 1));
  put_submessage(secured, 0x30, 1, body);
  put_submessage(secured, 0x32, 1, postfix);
  Datagram signed_message = of_submessage(0x33, 1, Datagram(20, 1));
  put_submessage(signed_message, 0x0c, 1, source);
  signed_message = joined(signed_message, heartbeat(1, 4, 1));
  put_submessage(signed_message, 0x34, 1, postfix);

  Datagram at_once = of_submessage(0x0e, 1, Datagram(12, 9));
  put_submessage(at_once, 0x09, 1, words({1, 2}));
  at_once = joined(joined(at_once, sample(4, 64)), heartbeat(1, 4, 2));
  const Datagram keyed = list_of({{0x0070, Datagram(16, 3)}, {0x0071, {0, 0, 0, 0}}});
  return {{"samples", sample(1)},
          {"keyed sample", data(kSamplesWriter, 2, keyed, payload_of(1, Datagram(64, 1)))},
          {"destination, time, sample, heartbeat", at_once},
          {"heartbeat", heartbeat(1, 100, 3)},
          {"gap", gap(5, 9, 0)},
          {"acknowledgement", acknack(7, {0x80000000, 1})},
          {"missing fragments", nack_frag(3, 1, 0xc0000000)},
          {"announced fragments", heartbeat_frag(3, 12)},
          {"first fragment", data_frag(1, 1, 1024, 2048, 1024)},
          {"last fragment", data_frag(2, 1, 1024, 2000, 976)},
          {"participant", announcement()},
          {"endpoint", endpoint(1)},
          {"goodbye", goodbye(kSender)},
          {"liveliness", data({0, 2, 0, 0xc2}, 1, {}, payload_of(1, liveliness))},
          {"handshake", data({0, 2, 1, 0xc3}, 1, {}, payload_of(1, handshake))},
          {"protected submessage", secured},
          {"signed message", signed_message}};
}

}  // namespace fieldcast::testing

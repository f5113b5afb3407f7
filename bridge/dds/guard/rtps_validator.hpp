// Validates one RTPS datagram (RTPS 2.2, chapter 9.4; DDS Security 1.1, 7.3.6) before the DDS
// library reads it, and reports the facts that the guard needs. Pure and stateless. Fast DDS 2.9.1
// and 3.1.2 trust many lengths and counts: the validator accepts only those within the bounds of
// the datagram and of RtpsLimits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "bridge/dds/guard/parameter_list.hpp"
#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

// Facts of a submessage for the guard. Spans point into the datagram.
struct RtpsEvent {
  Submessage kind{};
  std::size_t at = 0;  // of the submessage, in the datagram
  bool little = false;
  bool is_protected = false;  // DDS Security: a change would make it invalid
  ParticipantPrefix to{};     // whom it is for; zeros: everyone
  EntityBytes reader{}, writer{};
  std::int64_t first = 0;  // a sequence number: of DATA, DATA_FRAG, the start of GAP, of HEARTBEAT
  // The first number after the range of GAP or HEARTBEAT; of ACKNACK: the first one not received.
  std::int64_t base = 0;
  std::uint32_t count = 0;        // of HEARTBEAT and ACKNACK
  std::uint32_t sample_size = 0;  // of DATA_FRAG
  // Of DATA_FRAG: the bytes that the library needs for the sample. It keeps its list of missing
  // fragments in 4 bytes of each one (CacheChange.h), which exceed a last fragment of 1 to 3 bytes.
  std::uint32_t buffer_size = 0;
  std::size_t parameters_at = 0;  // of discovery DATA: the offset of its list in the datagram
  ParameterFacts parameters;      // of discovery DATA and of inline QoS
};

class RtpsEvents {
 public:
  virtual ~RtpsEvents() = default;
  // Called in order for DATA of discovery, DATA_FRAG, GAP, HEARTBEAT, ACKNACK. A fault refuses the
  // datagram.
  virtual std::optional<RtpsFault> on_event(const RtpsEvent& event) = 0;
};

// Returns the first fault of the datagram. `events` may be null.
[[nodiscard]] std::optional<RtpsFault> fault_of(std::span<const std::uint8_t> datagram,
                                                const RtpsLimits& limits,
                                                RtpsEvents* events = nullptr);

// Built-in entities (RTPS 2.2, 9.3.1.2).
inline constexpr std::uint8_t kBuiltIn = 0xc0;  // in the last byte, the kind
inline constexpr EntityBytes kPublicationsWriter{0x00, 0x00, 0x03, 0xc2};
inline constexpr EntityBytes kSubscriptionsWriter{0x00, 0x00, 0x04, 0xc2};

}  // namespace fieldcast

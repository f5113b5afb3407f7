// Checks a parameter list (RTPS 2.2, 9.4.2.11 and 9.6.2) before the library parses it. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

// The parts of a parameter list that the guard uses itself. Spans point into the list.
struct ParameterFacts {
  std::span<const std::uint8_t> participant_guid;  // 16 bytes, or empty
  std::span<const std::uint8_t> endpoint_guid;     // 16 bytes, or empty
  std::span<const std::uint8_t> key_hash;          // 16 bytes, or empty
  std::uint32_t lease_seconds = 0;                 // of a participant
  // The addresses (16 bytes) at which a participant receives.
  std::vector<std::span<const std::uint8_t>> addresses;
  std::uint8_t status = 0;  // of PID_STATUS_INFO: 1 disposed, 2 unregistered
  std::size_t size = 0;     // bytes of the list with its sentinel
  // Offsets of parameters that the library must not parse: type descriptions, content filters.
  std::vector<std::size_t> hidden;
};

// Returns the first fault. `facts` is complete if there is none.
[[nodiscard]] std::optional<RtpsFault> check_parameters(std::span<const std::uint8_t> list,
                                                        bool little, ParameterFacts& facts);

// Builds the message by which a participant leaves the domain (RTPS 2.2, 8.5.3.3.2). It is sent to
// our library in the participant's name, so that the library removes it.
using ParticipantPrefix = std::array<std::uint8_t, 12>;  // of the GUIDs of a participant
using EntityBytes = std::array<std::uint8_t, 4>;
// RTPS 2.2, 9.3.1.2.
inline constexpr EntityBytes kParticipantWriter{0x00, 0x01, 0x00, 0xc2};
inline constexpr EntityBytes kParticipantReader{0x00, 0x01, 0x00, 0xc7};

// `number` of the message must be greater than all earlier numbers of the writer.
[[nodiscard]] std::vector<std::uint8_t> participant_gone(const ParticipantPrefix& prefix,
                                                         std::uint64_t number);
// Such messages for `others` and then for a discovery server itself, in its name, numbered from
// `number`. A heartbeat precedes them, so that a reliable reader does not wait. The reader counts
// from its last number to this one, so `number` must not be far away.
[[nodiscard]] std::vector<std::uint8_t> participants_gone(std::span<const ParticipantPrefix> others,
                                                          const ParticipantPrefix& server,
                                                          std::uint64_t number);

}  // namespace fieldcast

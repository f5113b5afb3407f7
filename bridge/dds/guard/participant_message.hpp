// Builds the message by which a participant leaves the domain (RTPS 2.2, 8.5.3.3.2). It is sent to
// our library in the participant's name, so that the library removes it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fieldcast {

using ParticipantPrefix = std::array<std::uint8_t, 12>;  // of the GUIDs of a participant
using EntityBytes = std::array<std::uint8_t, 4>;
// RTPS 2.2, 9.3.1.2.
inline constexpr EntityBytes kParticipantWriter{0x00, 0x01, 0x00, 0xc2};
inline constexpr EntityBytes kParticipantReader{0x00, 0x01, 0x00, 0xc7};

// `number` of the message must be greater than all earlier numbers of the writer.
[[nodiscard]] std::vector<std::uint8_t> participant_gone(const ParticipantPrefix& prefix,
                                                         std::uint64_t number);
// Builds such messages for `others` and then for a discovery server itself, in the server's name,
// numbered from `number`. A heartbeat precedes them, so that a reliable reader does not wait for
// earlier messages. The reader counts from its last number to this one, so `number` must not be far
// away.
[[nodiscard]] std::vector<std::uint8_t> participants_gone(std::span<const ParticipantPrefix> others,
                                                          const ParticipantPrefix& server,
                                                          std::uint64_t number);

}  // namespace fieldcast

// The message by which a participant says that it leaves the domain (RTPS 2.2, 8.5.3.3.2), made in
// its name so that the library forgets it.
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

// `number`: of the message, greater than those of the writer so far.
[[nodiscard]] std::vector<std::uint8_t> participant_gone(const ParticipantPrefix& prefix,
                                                         std::uint64_t number);
// The same of others and then of a discovery server itself, in the server's name. The numbers
// begin with this one. A heartbeat stands before them, by which a reliable reader does not wait for
// what it has not got; it counts from its last number to this one, which is no far one therefore.
[[nodiscard]] std::vector<std::uint8_t> participants_gone(std::span<const ParticipantPrefix> others,
                                                          const ParticipantPrefix& server,
                                                          std::uint64_t number);

}  // namespace fieldcast

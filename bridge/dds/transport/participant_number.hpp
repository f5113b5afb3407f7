// Changes the sequence number of the announcements of a participant to discovery servers.
//
// A server of Fast DDS 2.9.1 distinguishes new and old announcements by the writer's number in a
// parameter of the message. After the server has removed a participant, it compares that number
// with its own number of the removal message, until all clients have acknowledged it. A participant
// that returns in that time counts from 1, and its announcement is dropped
// (DiscoveryDataBase::update_participant_from_change_). The server keeps its endpoints without a
// participant, so they are not found until the server restarts. Here, the numbers are above all
// numbers of a server. Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fieldcast {

// Returns the message to send in place of `message`. Empty if `message` is not an announcement of
// this participant.
[[nodiscard]] std::vector<std::uint8_t> with_number_above_servers(
    std::span<const std::uint8_t> message);

}  // namespace fieldcast

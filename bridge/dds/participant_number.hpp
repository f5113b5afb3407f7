// The number of what a participant announces to discovery servers.
//
// A server of Fast DDS 2.9.1 tells a new announcement from an old one by the number that its
// writer gave it, which stands before it. When the server has given a participant up, it compares
// that with a number of its own, that of its note of the end, until everybody has acknowledged the
// note; a participant that comes back meanwhile counts from 1, and is dropped
// (DiscoveryDataBase::update_participant_from_change_). What it then says of its endpoints stays in
// the server as nobody's, so that they are not found later either, until the server starts anew.
// Here its numbers are above all of a server. Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fieldcast {

// Of a message that this participant sends: what is to be sent in its place. Empty: the message is
// no announcement of this participant.
[[nodiscard]] std::vector<std::uint8_t> with_number_above_servers(
    std::span<const std::uint8_t> message);

}  // namespace fieldcast

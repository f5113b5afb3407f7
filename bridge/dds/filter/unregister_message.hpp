// Builds an unregister message that every vendor can read.
//
// RTPS 2.2, 9.6.3.4 and 8.7.4: DATA with STATUS_INFO, and the serialized key as its payload. Fast
// DDS 2.9.1 sends only a hash of the key, from which Cyclone DDS gets no key: it prints an error
// and keeps the instance. Here the message is written as an ordinary one whose payload is the key.
// A mark in its inline QoS has exactly the length of the final parameters; the transport replaces
// the mark when it sends the message. Pure; any thread.
#pragma once

#include <cstdint>
#include <span>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

// The mark of an unregister message, for its related sample identity.
[[nodiscard]] rtps::SampleIdentity unregister_mark(const rtps::InstanceHandle_t& key);

// Returns true if a whole RTPS message contains a marked DATA.
[[nodiscard]] bool holds_marks(std::span<const std::uint8_t> message);

// Turns every marked DATA of an RTPS message into an unregister message: replaces the mark by
// KEY_HASH and STATUS_INFO, and flags the payload as a key. The length is unchanged. Other messages
// are not changed.
void turn_marks_into_notes(std::span<std::uint8_t> message);

}  // namespace fieldcast

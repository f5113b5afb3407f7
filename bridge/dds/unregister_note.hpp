// The note that an instance is let go, in the form that every vendor can read.
//
// RTPS 2.2, 9.6.3.4 and 8.7.4: DATA with STATUS_INFO, and the serialized key as its payload. Fast
// DDS 2.9.1 sends a hash of the key alone, from which Cyclone DDS gets no key: it says so on
// standard error and keeps the instance. Here the note is written as an ordinary message whose
// payload is the key, with a mark in its inline QoS that is exactly as long as what replaces it;
// the transport replaces it on the way out. Pure; any thread.
#pragma once

#include <cstdint>
#include <span>

#include "bridge/dds/fastdds.hpp"

namespace fieldcast {

// What marks a message as such a note: to be its related sample identity.
[[nodiscard]] rtps::SampleIdentity unregister_mark(const rtps::InstanceHandle_t& key);

// Whether a whole RTPS message holds a marked DATA.
[[nodiscard]] bool holds_marks(std::span<const std::uint8_t> message);

// Every marked DATA of an RTPS message becomes the note: the mark makes room for KEY_HASH and
// STATUS_INFO, the payload is called a key. Nothing changes its length; what is no such message
// stays as it is.
void turn_marks_into_notes(std::span<std::uint8_t> message);

}  // namespace fieldcast

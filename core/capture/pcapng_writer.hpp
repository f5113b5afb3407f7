// Writes the blocks of a pcapng file (pcapng.hpp): one section, one interface, packets with
// microseconds, direction and comment, and the number of lost packets at the end. Little-endian.
// Pure: each function appends one whole block to `out`. Any thread.
#pragma once

#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/capture/capture_record.hpp"

namespace fieldcast::pcapng {

// Starts a file. Both texts are one human-readable line.
void append_section(Bytes& out, std::string_view application, std::string_view comment);
void append_interface(Bytes& out, std::string_view name, std::string_view description);

struct Packet {
  UtcTime at;
  Direction direction = Direction::kReceived;
  ByteView data;             // with its tags (upper_pdu.hpp)
  std::string_view comment;  // empty if there is none
};
// REQUIRES: an interface precedes it; data and comment have less than 60 000 bytes each.
void append_packet(Bytes& out, const Packet& packet);

struct Statistics {
  UtcTime begun, ended;
  std::uint64_t frames = 0, dropped = 0;
  std::string_view comment;
};
void append_statistics(Bytes& out, const Statistics& statistics);

}  // namespace fieldcast::pcapng

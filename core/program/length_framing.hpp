// The framing that our own client asks for: any bytes at all, nothing to search, nothing held back.
//
//     length(4) bytes       1 .. kMaxChunk, big-endian
//     00000000              heartbeat
//     FFFFFFFF              stop; the bridge may say why in one marker frame behind it (@@0003FEFF)
//     FFFFFFFE baud(4) stop(1) data(1) parity(1)
//                           settings of the real line, client to bridge (ours)
//
// baud 0 leaves the baud rate, data 0 leaves data bits and parity as the bridge's configuration has
// them. parity: 0 none, 1 even, 2 odd.
#pragma once

#include <variant>

#include "core/program/frame.hpp"

namespace fieldcast::program {

inline constexpr std::uint32_t kMaxChunk = 65536;  // more is a lost stream, not a long one

struct ChunkBytes {
  ByteView bytes;  // of the input: a part of a chunk as soon as it is there
};
struct Heartbeat {};
struct Stop {};
using LengthFrame = std::variant<ChunkBytes, Heartbeat, Stop, LineSettings, FrameFault>;

class LengthReader {
 public:
  // Takes what it understands from the front of `in`; nothing when all is taken. After Stop and
  // after a fault the stream is over.
  [[nodiscard]] std::optional<LengthFrame> next(ByteView& in);
  // In the middle of a head or a chunk.
  [[nodiscard]] bool partial() const { return left_ > 0 || !head_.empty(); }

 private:
  Bytes head_;              // what has come of a head
  std::uint32_t left_ = 0;  // of the chunk
};

// Appends one chunk after another until all bytes are in.
void append_chunks(Bytes& out, ByteView bytes);
void append_heartbeat(Bytes& out);
void append_stop(Bytes& out);
void append_settings(Bytes& out, const LineSettings& settings);

}  // namespace fieldcast::program

// Framing used by our own client: carries any bytes, without search or delay.
//
//     length(4) bytes       1 .. kMaxChunk, big-endian
//     00000000              heartbeat
//     FFFFFFFF              stop; the bridge may add the reason as a marker frame (@@0003FEFF)
//     FFFFFFFE baud(4) stop(1) data(1) parity(1)
//                           settings of the real line, client to bridge (ours)
//
// baud 0 keeps the configured baud rate, data 0 the configured data bits and parity. parity: 0
// none, 1 even, 2 odd.
#pragma once

#include <variant>

#include "core/program/frame.hpp"

namespace fieldcast::program {

// A larger length means that the stream is out of step.
inline constexpr std::uint32_t kMaxChunk = 65536;

struct ChunkBytes {
  ByteView bytes;  // refers to the input; may be a part of a chunk
};
struct Heartbeat {};
struct Stop {};
using LengthFrame = std::variant<ChunkBytes, Heartbeat, Stop, LineSettings, FrameFault>;

class LengthReader {
 public:
  // Consumes a frame from the front of `in`; empty at its end. After Stop or a fault the stream
  // ends.
  [[nodiscard]] std::optional<LengthFrame> next(ByteView& in);
  [[nodiscard]] bool partial() const { return left_ > 0 || !head_.empty(); }

 private:
  Bytes head_;              // received part of a head
  std::uint32_t left_ = 0;  // of the chunk
};

void append_chunks(Bytes& out, ByteView bytes);
void append_heartbeat(Bytes& out);
void append_stop(Bytes& out);
void append_settings(Bytes& out, const LineSettings& settings);

}  // namespace fieldcast::program

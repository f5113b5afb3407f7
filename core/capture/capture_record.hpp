// Records of a bus during a capture, and the resulting frames. Plain values, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct CaptureRecord {
  enum class Kind : std::uint8_t {
    kSent,      // bytes; the text is their purpose
    kReceived,  // bytes: one piece as received from the port
    kRemark,    // text: outcome of an exchange, or state of the port
    kEnded,     // the exchange ended: later bytes do not belong to it
  };
  Kind kind = Kind::kReceived;
  UtcTime at;              // kReceived: arrival of the last byte
  std::size_t device = 0;  // kSent: index in the bus's list
  Bytes bytes;
  std::string text;
};

enum class Direction : std::uint8_t { kSent, kReceived };

struct CapturedFrame {
  UtcTime at;
  Direction direction = Direction::kReceived;
  std::size_t device = 0;  // last polled device
  Bytes bytes;             // never empty
  std::string comment;     // text lines; may be empty
};

}  // namespace fieldcast

// What a bus says of its wire while it is captured, and the frames that come of it. Plain values,
// any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct CaptureRecord {
  enum class Kind : std::uint8_t {
    kSent,      // bytes, and in text what they are for
    kReceived,  // bytes: a piece as the port brought it
    kRemark,    // text: how an exchange ended, or what became of the port
    kEnded,     // the exchange is over: what comes next does not belong to it
  };
  Kind kind = Kind::kReceived;
  UtcTime at;              // kReceived: when the last byte arrived
  std::size_t device = 0;  // kSent: of the bus's list
  Bytes bytes;
  std::string text;
};

enum class Direction : std::uint8_t { kSent, kReceived };

// One frame, or what was received instead of one.
struct CapturedFrame {
  UtcTime at;
  Direction direction = Direction::kReceived;
  std::size_t device = 0;  // that was asked last
  Bytes bytes;             // never empty
  std::string comment;     // text lines; may be empty
};

}  // namespace fieldcast

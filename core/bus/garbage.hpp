// What comes on the wire in place of a device's answers: how much, what it looks like, what to try.
// A wrong baud rate or parity shows in the bytes themselves. Pure value, one for each device, owned
// by the DeviceMonitor, on the bus's thread. Nothing can fail.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"

namespace fieldcast {

class Garbage {
 public:
  // One broken answer is noise. This many in a row, with no answer between them, are told.
  static constexpr unsigned kWorthSaying = 3;
  static constexpr std::size_t kShown = 16;  // of the bytes, in the text
  static constexpr std::size_t kKept = 128;  // of the bytes, the last ones, to judge by

  // A try failed after these bytes. True: worth saying now, see text().
  [[nodiscard]] bool received(ByteView bytes, ByteView request);
  // A valid answer. True: text() was worth saying before.
  bool answered();

  // "bytes come that are no answer: 57 in 3 exchanges, the last ones 00 F8 80: <what they look
  // like>; try <what>".
  [[nodiscard]] std::string text(const LineFormat& line, bool over_network) const;

 private:
  unsigned exchanges_ = 0;   // in a row
  std::uint64_t bytes_ = 0;  // in them
  bool echo_ = true;         // each was the request, or a part of it
  Bytes last_;
};

// What bytes look like that came where answers of this line were wanted, and what to try: one
// clause for people. REQUIRES: not empty.
[[nodiscard]] std::string looks_like(ByteView bytes, const LineFormat& line, bool over_network);

}  // namespace fieldcast

// What comes on the wire in place of a device's answers: how much, what it looks like, what to try.
// A wrong baud rate or parity shows in the bytes themselves. Pure value, one for each device, owned
// by the DeviceMonitor, on the bus's thread. Nothing can fail.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"

namespace fieldcast {

// What a broken answer has in common with the one that was expected. kOther: it does not even begin
// like one, or its length is not known.
enum class AnswerShape : std::uint8_t { kOther, kCut, kWhole, kLong };

// Compares bytes with the first two characters of their request, with which an answer of Modbus and
// Host Link begins too, and with the number of characters that the whole answer has. `expected` 0:
// that number is not known.
[[nodiscard]] AnswerShape answer_shape(ByteView bytes, ByteView request, std::size_t expected);

// What a broken answer of this shape means and what to do: one clause for users. REQUIRES: not
// kOther.
[[nodiscard]] std::string_view broken_answer_text(AnswerShape shape);

class Garbage {
 public:
  // One broken answer is noise. This many in a row, with no answer between them, are told.
  static constexpr unsigned kWorthSaying = 3;
  static constexpr std::size_t kShown = 16;  // of the bytes, in the text
  static constexpr std::size_t kKept = 128;  // of the bytes, the last ones, to judge by

  // A try failed after these bytes. True: worth saying now, see text().
  // `expected`: characters of the whole answer, 0: not known.
  [[nodiscard]] bool received(ByteView bytes, ByteView request, std::size_t expected);
  // A valid answer. True: text() was worth saying before.
  bool answered();

  // "bytes come that are no answer: 57 in 3 exchanges, the last ones 00 F8 80: <what they look
  // like>; try <what>".
  [[nodiscard]] std::string text(const LineFormat& line, bool over_network) const;

 private:
  [[nodiscard]] AnswerShape shape() const;

  unsigned exchanges_ = 0;            // in a row
  std::uint64_t bytes_ = 0;           // in them
  bool echo_ = true;                  // each was the request, or a part of it
  std::array<unsigned, 4> shapes_{};  // how many of each AnswerShape
  Bytes last_;
};

// What bytes look like that came where answers of this line were wanted, and what to try: one
// clause for people. REQUIRES: not empty.
[[nodiscard]] std::string looks_like(ByteView bytes, const LineFormat& line, bool over_network);

}  // namespace fieldcast

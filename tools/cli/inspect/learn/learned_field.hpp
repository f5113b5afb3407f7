// A field of a frame of an unknown protocol, as far as a capture shows it. Plain value.
#pragma once

#include <string>

#include "tools/cli/inspect/learn/frames.hpp"

namespace fieldcast::learn {

struct LearnedField {
  declared::FieldKind kind = declared::FieldKind::kUnused;
  std::ptrdiff_t at = 0;  // below 0: from the end of the frame
  std::size_t width = 0;  // characters; 0: as many as the others leave
  declared::Word word;    // of a number
  Evidence evidence;
  std::string note;     // why it is unsure; empty if it is sure
  std::string options;  // further keys of the declaration: ", kind: sum"
  Bytes constant;
  std::int64_t plus = 0;
  std::uint8_t add = 0;      // added to each byte on the wire
  bool variable = false;     // a text that ends at the constant behind it
  bool pairs = false;        // a length or checksum of bytes, each in two hexadecimal digits
  std::ptrdiff_t from = -1;  // first character that a length or a checksum covers
  // The response has it so many characters later; empty: it has not.
  std::optional<std::ptrdiff_t> echo;
  std::string name, of;  // unique in its frame; the covered fields
  [[nodiscard]] std::ptrdiff_t end() const { return at + static_cast<std::ptrdiff_t>(width); }
  [[nodiscard]] bool holds(std::ptrdiff_t column) const { return column >= at && column < end(); }
};

}  // namespace fieldcast::learn

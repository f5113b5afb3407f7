// Reads and writes the frames of a declaration as its device does. Written apart from the bridge's
// interpreter of declarations: they share the data, which the loader made, and the checksums.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::sim {

// What a frame says, or is to say.
struct DeclaredText {
  std::uint64_t address = 0, command = 0, first = 0, count = 0, sequence = 0, error = 0;
  std::vector<std::uint64_t> items;                         // right-aligned
  std::map<const declared::Field*, std::uint64_t> numbers;  // of a record's values
  std::map<const declared::Field*, std::string> texts;
};

struct DeclaredMatch {
  enum class Fit : std::uint8_t { kNo, kMore, kWhole };
  Fit fit = Fit::kNo;
  std::size_t size = 0;  // of a whole one
  bool bad_check = false;
  bool contradicts = false;  // a length or a count that is not what the rest says
  DeclaredText text;
};

// What the operation's request says, if these bytes begin with one.
[[nodiscard]] DeclaredMatch on_request(const declared::Declaration& declaration,
                                       const declared::Operation& operation, ByteView bytes);

[[nodiscard]] Bytes say(const declared::Frame& frame, unsigned item_bits, const DeclaredText& text);

}  // namespace fieldcast::sim

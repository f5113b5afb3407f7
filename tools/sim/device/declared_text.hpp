// Parses and encodes the frames of a declaration for its device. Independent of the bridge's
// interpreter; both use the loaded declaration and the checksums.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::sim {

struct DeclaredText {
  std::uint64_t address = 0, command = 0, first = 0, count = 0, sequence = 0, error = 0;
  std::vector<std::uint64_t> items;                         // right-aligned
  std::map<const declared::Field*, std::uint64_t> numbers;  // values of a record
  std::map<const declared::Field*, std::string> texts;
};

struct DeclaredMatch {
  enum class Fit : std::uint8_t { kNo, kMore, kWhole };
  Fit fit = Fit::kNo;
  std::size_t size = 0;  // size of a whole frame
  bool bad_check = false;
  bool contradicts = false;  // a length or count differs from the rest of the frame
  DeclaredText text;
};

// Parses the operation's request at the start of these bytes.
[[nodiscard]] DeclaredMatch on_request(const declared::Declaration& declaration,
                                       const declared::Operation& operation, ByteView bytes);

[[nodiscard]] Bytes say(const declared::Frame& frame, unsigned item_bits, const DeclaredText& text);

}  // namespace fieldcast::sim

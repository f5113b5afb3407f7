// Parses and encodes declared frames for the device. Shares the loaded declaration and the
// checksums with the bridge, but not its interpreter.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::sim {

struct DeclaredText {
  std::uint64_t address = 0, command = 0, first = 0, count = 0, sequence = 0, error = 0;
  std::optional<std::uint64_t> rate;                        // code of a baud rate
  std::string name;                                         // an address that is text
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

// `own_name`: address of the device if it is text.
[[nodiscard]] DeclaredMatch on_request(const declared::Declaration& declaration,
                                       const declared::Operation& operation, ByteView bytes,
                                       std::string_view own_name);

[[nodiscard]] Bytes say(const declared::Frame& frame, unsigned item_bits, DeclaredText text);

}  // namespace fieldcast::sim

// Finds the checksum of a set of frames by trying: every kind that a declaration has, over each
// plausible span. Pure.
#pragma once

#include <string_view>

#include "tools/cli/inspect/learn/frames.hpp"

namespace fieldcast::learn {

struct FoundChecksum {
  std::string_view kind;  // as a declaration names it: "sum", "lrc", "crc-16/modbus"
  declared::Check check;
  declared::Word word;
  std::size_t from = 0;     // first covered character
  std::size_t gap = 0;      // characters between the covered ones and the checksum
  std::size_t trailer = 0;  // characters behind the checksum
  Evidence evidence;
  std::size_t values = 0;  // different values of the checksum that fit
  [[nodiscard]] std::size_t end_size() const { return gap + word.characters + trailer; }
  // Below 0, as it is counted from the end.
  [[nodiscard]] std::ptrdiff_t at() const {
    return -static_cast<std::ptrdiff_t>(word.characters + trailer);
  }
  [[nodiscard]] bool fits(ByteView frame) const;
  // Over bytes, each field is a number of whole bytes, of two digits each: extends the columns
  // at .. end-1. False if it is not over bytes, or does not cover them.
  bool align(std::ptrdiff_t& at, std::ptrdiff_t& end) const;
};

// Empty if none fits nearly all frames, or if so few values could fit by chance.
[[nodiscard]] std::optional<FoundChecksum> find_checksum(const Frames& frames, bool text);

// The checksum that the frames of the other direction have, if it also fits these: there are few
// ways to fit, so that few frames suffice.
[[nodiscard]] std::optional<FoundChecksum> find_same_checksum(const Frames& frames,
                                                              const FoundChecksum& other);

}  // namespace fieldcast::learn

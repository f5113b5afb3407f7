// One reading of a frame: its fields by one frame of the declaration, and what speaks for it. Pure.
#pragma once

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::declared {

struct Reading {
  std::vector<FrameField> fields;
  bool faultless = true;
  bool from_sender = true;
  std::int64_t evidence = 0;  // characters that must be as they are, without those that are wrong
  [[nodiscard]] auto rank() const { return std::tuple(faultless, from_sender, evidence); }
  // Whether another operation has the same request or response.
  [[nodiscard]] bool is_like(const Reading& other) const {
    const auto kind = [](const Reading& each) {
      return each.fields.front().value.substr(0, each.fields.front().value.find(':'));
    };
    const auto equal = [](const FrameField& a, const FrameField& b) {
      return a.offset == b.offset && a.name == b.name && a.value == b.value;
    };
    return faultless && rank() == other.rank() && kind(*this) == kind(other) &&
           std::equal(fields.begin() + 1, fields.end(), other.fields.begin() + 1,
                      other.fields.end(), equal);
  }
};

// `area`: null for a round without items. `by_length`: the field of variable length extends as a
// length field says, else to the fields behind it.
[[nodiscard]] Reading read_frame(const Declaration& declaration, const Operation& operation,
                                 const DeclaredArea* area, const Frame& frame, ByteView bytes,
                                 const std::string& title, bool refusal, bool by_length);

// The bytes at the start of a frame that equal the first one.
[[nodiscard]] inline std::size_t equal_bytes(ByteView bytes) {
  const auto other =
      std::ranges::find_if(bytes, [&](std::uint8_t byte) { return byte != bytes.front(); });
  return static_cast<std::size_t>(other - bytes.begin());
}

}  // namespace fieldcast::declared

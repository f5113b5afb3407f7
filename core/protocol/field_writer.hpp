// Converts positions in decoded bytes to characters on the wire, so that one explanation serves
// binary and hexadecimal frames.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/message_text.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Characters of a frame for a text: others than ASCII as "<0D>".
[[nodiscard]] inline std::string printable(ByteView characters) {
  std::string text;
  for (const std::uint8_t c : characters) {
    if (c >= 0x20 && c < 0x7F)
      text += static_cast<char>(c);
    else
      text += "<" + to_hex({&c, 1}) + ">";
  }
  return text;
}

class FieldWriter {
 public:
  // `base`: offset of decoded byte 0; `stride`: characters per byte (1 binary, 2 hexadecimal).
  explicit FieldWriter(std::size_t base = 0, std::size_t stride = 1, unsigned depth = 0)
      : base_(base), stride_(stride), depth_(depth) {}

  void add(std::size_t at, std::size_t length, std::string name, const std::string& value,
           const std::string& fault = {}) {
    // Both may contain characters of the frame.
    fields_.push_back({depth_, base_ + at * stride_, length * stride_, std::move(name),
                       escaped(value), escaped(fault)});
  }
  void remark(std::string value, std::string fault = {}) {
    fields_.push_back({depth_, base_, 0, "frame", std::move(value), std::move(fault)});
  }
  void deeper() { ++depth_; }
  void higher() { --depth_; }
  void append(std::vector<FrameField> fields) {
    fields_.insert(fields_.end(), std::make_move_iterator(fields.begin()),
                   std::make_move_iterator(fields.end()));
  }
  [[nodiscard]] unsigned depth() const { return depth_; }
  [[nodiscard]] std::vector<FrameField> take() { return std::move(fields_); }

 private:
  std::vector<FrameField> fields_;
  std::size_t base_;
  std::size_t stride_;
  unsigned depth_;
};

}  // namespace fieldcast

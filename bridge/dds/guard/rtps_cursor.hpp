// Reads numbers of one byte order from a span of bytes in the layout of CDR and RTPS. A read past
// the end makes the cursor bad and returns 0, so that a caller checks once at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace fieldcast {

class RtpsCursor {
 public:
  RtpsCursor(std::span<const std::uint8_t> bytes, bool little) : bytes_(bytes), little_(little) {}

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  // A sequence number: the upper half first, signed (RTPS 2.2, 9.4.2.5).
  std::int64_t sequence_number() {
    const auto high = static_cast<std::int32_t>(u32());
    const std::uint32_t low = u32();
    return static_cast<std::int64_t>(high) * (std::int64_t{1} << 32) + low;
  }
  // The next `count` bytes; empty and bad if there are not as many.
  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > left()) {
      good_ = false;
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  // Skips the padding up to a multiple of 4, as far as there is some.
  void align() {
    const std::size_t padding = (4 - at_ % 4) % 4;
    at_ += padding < left() ? padding : left();
  }

 private:
  std::uint32_t number(std::size_t size) {
    std::uint32_t value = 0;
    const auto raw = take(size);
    for (std::size_t i = 0; i < raw.size(); ++i)
      value = value << 8 | raw[little_ ? raw.size() - 1 - i : i];
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool little_;
  bool good_ = true;
};

}  // namespace fieldcast

namespace fieldcast::cdr_walk {

// Walk over CDR values without building them: each function returns false if a length or a count is
// above its limit or past the end. Pure.
inline constexpr std::uint32_t kLongestText = 256;        // a name of DDS, with its final zero
inline constexpr std::uint32_t kLongestProperty = 32768;  // a certificate or permissions
inline constexpr std::uint32_t kMostItems = 128;          // partitions, properties

// A string: its length with the final zero, its bytes, padding.
[[nodiscard]] inline bool is_text(RtpsCursor& in, std::uint32_t longest) {
  const std::uint32_t length = in.u32();
  if (!in.good() || length == 0 || length > longest) return false;
  const auto text = in.take(length);
  if (!in.good() || text.back() != 0) return false;
  in.align();
  return true;
}

[[nodiscard]] inline bool is_data(RtpsCursor& in, std::uint32_t longest) {
  const std::uint32_t length = in.u32();
  if (!in.good() || length > longest) return false;
  in.take(length);
  in.align();
  return in.good();
}

[[nodiscard]] inline bool are_texts(RtpsCursor& in) {
  const std::uint32_t count = in.u32();
  if (!in.good() || count > kMostItems) return false;
  for (std::uint32_t i = 0; i < count; ++i)
    if (!is_text(in, kLongestText)) return false;
  return true;
}

// Pairs of strings, then, if more bytes follow, pairs of a string and bytes.
[[nodiscard]] inline bool are_properties(RtpsCursor& in) {
  const std::uint32_t count = in.u32();
  if (!in.good() || count > kMostItems) return false;
  for (std::uint32_t i = 0; i < count; ++i)
    if (!is_text(in, kLongestText) || !is_text(in, kLongestProperty)) return false;
  if (in.left() < 4) return true;
  const std::uint32_t binaries = in.u32();
  if (binaries > kMostItems) return false;
  for (std::uint32_t i = 0; i < binaries; ++i)
    if (!is_text(in, kLongestText) || !is_data(in, kLongestProperty)) return false;
  return in.good();
}

// DDS Security 1.1, 7.2.3: a class and its properties.
[[nodiscard]] inline bool is_token(RtpsCursor& in) {
  return is_text(in, kLongestText) && are_properties(in);
}

}  // namespace fieldcast::cdr_walk

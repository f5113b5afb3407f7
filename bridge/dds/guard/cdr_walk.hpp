// Walk over CDR values without building them: each function returns false if a length or a count is
// above its limit or past the end. Pure.
#pragma once

#include "bridge/dds/guard/rtps_cursor.hpp"

namespace fieldcast::cdr_walk {

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

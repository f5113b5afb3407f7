// Compresses a payload with zstd and back (RFC 8878). Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace fieldcast::forward {

// Returns the frame, or the text itself if the frame would not be shorter. A frame begins with
// 28 B5 2F FD, which no payload of ours does.
[[nodiscard]] std::string compressed(std::string text);

inline constexpr std::size_t kMaxContent = std::size_t{16} << 20;  // bytes of a frame's content
// Returns the content of a frame, and any other text unchanged. Empty for a damaged frame, and for
// one without the size of its content or with more than kMaxContent.
[[nodiscard]] std::optional<std::string> decompressed(std::string_view text);

}  // namespace fieldcast::forward

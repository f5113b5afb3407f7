#include "tools/forward/payload/compression.hpp"

#include <zstd.h>

#include <utility>

namespace fieldcast::forward {

std::string compressed(std::string text) {
  constexpr int kLevel = 3;  // zstd's own default
  std::string frame(ZSTD_compressBound(text.size()), '\0');
  const std::size_t size =
      ZSTD_compress(frame.data(), frame.size(), text.data(), text.size(), kLevel);
  if (ZSTD_isError(size) != 0 || size >= text.size()) return text;
  frame.resize(size);
  return frame;
}

std::optional<std::string> decompressed(std::string_view text) {
  constexpr std::string_view kMagic = "\x28\xB5\x2F\xFD";
  if (!text.starts_with(kMagic)) return std::string(text);
  const unsigned long long size = ZSTD_getFrameContentSize(text.data(), text.size());
  // The values for errors are greater than every size.
  if (size > kMaxContent) return std::nullopt;
  std::string content(static_cast<std::size_t>(size), '\0');
  const std::size_t done =
      ZSTD_decompress(content.data(), content.size(), text.data(), text.size());
  if (ZSTD_isError(done) != 0 || done != content.size()) return std::nullopt;
  return content;
}

}  // namespace fieldcast::forward

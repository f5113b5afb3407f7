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

}  // namespace fieldcast::forward

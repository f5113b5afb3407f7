// Character sets that need tables, converted with iconv of the C library. Not thread-safe.
#pragma once

#include <array>
#include <memory>

#include "core/codec/text_codec.hpp"

namespace fieldcast {

class IconvCodec final : public TextCodec {
 public:
  IconvCodec();
  ~IconvCodec() override;

  std::string to_utf8(Charset charset, std::string_view bytes) override;
  std::optional<std::string> from_utf8(Charset charset, std::string_view text) override;

 private:
  class Conversion;
  // Returns null if the C library does not support the character set.
  Conversion* conversion(Charset charset, bool to_utf8);
  std::array<std::unique_ptr<Conversion>, 4> made_;  // gbk and shift-jis, each direction
};

}  // namespace fieldcast

// Character sets that need tables, by iconv of the C library. Opened when first needed; not for two
// threads at once.
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
  // Nothing when this machine's C library does not have the set.
  Conversion* conversion(Charset charset, bool to_utf8);
  std::array<std::unique_ptr<Conversion>, 4> made_;  // gbk and shift-jis, each way
};

}  // namespace fieldcast

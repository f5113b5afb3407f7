// Fuzz target: any bytes as LZW codes, and as data to compress; both against the dictionary of
// strings.
//
// Input: the original's length(2), then codes.
#include <cstdlib>

#include "core/codec/lzw.hpp"
#include "tests/core/lzw_reference.hpp"

namespace fieldcast {
namespace {

void run_one(ByteView data) {
  if (data.size() < 2) return;
  const std::size_t length = read_u16(data);
  const ByteView codes = data.subspan(2);
  Bytes out;
  if (const auto result = lzw_decode(codes, length, out)) {
    if (out.size() != length || test::reference_decode(codes, length) != out) std::abort();
    LzwEncoder encoder;  // these codes may be another choice of strings; what the encoder makes of
                         // it must come back
    Bytes again(3 * length + 16);
    const auto size = encoder.encode(out, again);
    Bytes back;
    if (!size || !lzw_decode(ByteView(again).first(*size), length, back) || back != out)
      std::abort();
  } else if (!out.empty()) {
    std::abort();
  }
  LzwEncoder encoder;
  Bytes packed(3 * codes.size() + 16);
  const auto size = encoder.encode(codes, packed);
  packed.resize(size.value_or(0));
  if (!size || packed != test::packed(test::reference_codes(codes))) std::abort();
}

}  // namespace
}  // namespace fieldcast

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fieldcast::run_one({data, size});
  return 0;
}

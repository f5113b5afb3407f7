// Fuzzes LZW: any bytes as codes and as data to compress, compared with the reference.
//
// Input: the original's length(2), then codes.
#include <cstdlib>

#include "core/codec/lzw.hpp"
#include "tests/core/lzw_reference.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

void run_one(ByteView data) {
  if (data.size() < 2) return;
  const std::size_t length = read_u16(data);
  const ByteView codes = data.subspan(2);
  Bytes out;
  if (const auto result = lzw_decode(codes, length, out)) {
    if (out.size() != length || test::reference_decode(codes, length) != out) std::abort();
    LzwEncoder encoder;  // the codes may use other strings than the encoder; its output
                         // must decode to the same data
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

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)

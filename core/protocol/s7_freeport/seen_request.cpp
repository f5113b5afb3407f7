// No response has 17 characters.
#include "core/protocol/seen_request.hpp"

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/s7_freeport/s7_freeport.hpp"

namespace fieldcast::s7_freeport {

SeenRequest seen_request(ByteView bytes) {
  if (bytes.size() < kRequest) return {};
  const ByteView frame = bytes.first(kRequest);
  const bool marked = frame.front() == 'q' && frame.back() == 'Q';
  if (!marked || (frame[1] != 'W' && frame[1] != 'R')) return {};
  const auto check = read_digits(frame.subspan(kRequest - 3, 2));
  if (check != xor8(frame.subspan(1, kRequest - 4))) return {};
  return {kRequest, true};
}

}  // namespace fieldcast::s7_freeport

// A request has an odd number of digits, a response an even one, except for the extended force.
#include "core/protocol/seen_request.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/mitsubishi_fx/areas.hpp"
#include "core/protocol/mitsubishi_fx/mitsubishi_fx.hpp"

namespace fieldcast::mitsubishi_fx {
namespace {

struct Shape {
  std::string_view command;
  std::size_t fixed;  // digits after the command
  bool data = false;  // the last two of the fixed digits count the data bytes that follow
};
constexpr std::array kShapes{Shape{"E00", 6}, Shape{"E10", 6, true}, Shape{"E7", 4}, Shape{"E8", 4},
                             Shape{"0", 6},   Shape{"1", 6, true},   Shape{"7", 4},  Shape{"8", 4}};

bool fits(const Shape& shape, ByteView body) {
  const std::size_t head = shape.command.size() + shape.fixed;
  if (body.size() < head || !std::equal(shape.command.begin(), shape.command.end(), body.begin()))
    return false;
  std::size_t data = 0;
  if (shape.data) {
    const auto count = read_digits(body.subspan(head - 2, 2));
    if (!count) return false;
    data = 2 * *count;
  }
  return body.size() == head + data;
}

}  // namespace

SeenRequest seen_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != kStx) return {};
  const auto etx = std::find(bytes.begin(), bytes.end(), kEtx);
  const auto end = static_cast<std::size_t>(etx - bytes.begin());  // of the body
  if (bytes.size() < end + 3) return {};
  const ByteView body = bytes.subspan(1, end - 1);
  if (read_digits(bytes.subspan(end + 1, 2)) != sum8(bytes.subspan(1, end))) return {};
  const bool request =
      std::ranges::any_of(kShapes, [&](const Shape& shape) { return fits(shape, body); });
  return {request ? end + 3 : 0, body.size() % 2 == 1};
}

}  // namespace fieldcast::mitsubishi_fx

#include "core/protocol/seen_request.hpp"

#include <string_view>

#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/omron_hostlink/omron_hostlink.hpp"

namespace fieldcast::omron {
namespace {

// After the header a response has an end code, then words or flags.
SeenRequest seen_c_mode(ByteView rest, char command, char area, std::size_t size) {
  if (std::string_view("RLHJDECG").find(area) == std::string_view::npos) return {};
  const std::size_t address = area == 'E' ? 6 : 4;
  if (command == 'W') return {rest.size() > address ? size : 0, true};
  if (command != 'R' || rest.size() != address + 4 || !read_digits(rest.last(8), 10)) return {};
  return {size, area != 'E' && area != 'G'};
}

SeenRequest seen_fins(ByteView rest, std::size_t size) {
  constexpr std::uint8_t kAnswer = 0x40;  // in ICF
  if (rest.size() % 2 == 0) return {};    // a response: its end code has two digits, `w` has one
  const auto message = read_hex_bytes(rest.subspan(1));
  if (!message || message->empty() || (message->front() & kAnswer) != 0) return {};
  return {size, true};
}

}  // namespace

SeenRequest seen_hostlink_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != kAt) return {};
  const ParseResult parsed = first_frame(bytes);
  const bool here = parsed.kind == ParseResult::Kind::kFrame && parsed.text.data() == bytes.data();
  if (!here || parsed.text.size() <= kHeadSize) return {};
  const auto command = static_cast<char>(parsed.text[3]), area = static_cast<char>(parsed.text[4]);
  const ByteView rest = parsed.text.subspan(kHeadSize);
  if (command == 'F' && area == 'A') return seen_fins(rest, parsed.end);
  return seen_c_mode(rest, command, area, parsed.end);
}

}  // namespace fieldcast::omron

#include "core/protocol/mitsubishi_mc_serial/seen_traffic.hpp"

#include <algorithm>
#include <string_view>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/mitsubishi_mc_serial/mitsubishi_mc_serial.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

std::optional<std::uint32_t> number_at(ByteView text, std::size_t at, std::size_t digits) {
  if (text.size() < at + digits) return std::nullopt;
  return read_digits(text.subspan(at, digits));
}

// command(4) subcommand(4), then device(8 or 12) points(4) data, or words(2) doubles(2) device..
std::optional<std::size_t> long_content(ByteView content) {
  const auto command = number_at(content, 0, 4), subcommand = number_at(content, 4, 4);
  if (!command || !subcommand || *subcommand > 3) return std::nullopt;
  const std::size_t device = *subcommand >= 2 ? 12 : 8;
  if (*command == 0x0403) {
    const auto words = number_at(content, 8, 2), doubles = number_at(content, 10, 2);
    if (!words || !doubles) return std::nullopt;
    return 12 + (*words + *doubles) * device;
  }
  if (*command != 0x0401 && *command != 0x1401) return std::nullopt;
  const std::size_t fixed = 8 + device + 4;
  const auto points = number_at(content, fixed - 4, 4);
  if (!points) return std::nullopt;
  return fixed + (*command == 0x0401 ? 0 : *points * (*subcommand % 2 != 0 ? 1 : 4));
}

// command(2) wait(1) device(5 or 7) points(2) data
std::optional<std::size_t> short_content(ByteView content) {
  if (content.size() < 2) return std::nullopt;
  const std::string_view command(reinterpret_cast<const char*>(content.data()), 2);
  const bool wide = command[0] == 'J' || command[0] == 'Q';
  const bool bits = command[0] == 'B' || command[0] == 'J';
  if ((!wide && !bits && command[0] != 'W') || (command[1] != 'R' && command[1] != 'W'))
    return std::nullopt;
  const std::size_t fixed = 3 + (wide ? 7 : 5) + 2;
  const auto points = number_at(content, fixed - 2, 2);
  if (!points) return std::nullopt;
  const std::size_t count = *points == 0 ? 256 : *points;
  return fixed + (command[1] == 'R' ? 0 : count * (bits ? 1 : 4));
}

std::optional<AsciiRequest> request_in(ByteView text, bool numbered) {
  if (numbered && !number_at(text, 0, kBlockDigits)) return std::nullopt;
  AsciiRequest request{.format = {.numbered = numbered}};
  request.format.frame = frame_of(text.subspan(numbered ? kBlockDigits : 0));
  const std::size_t header = header_size(request.format);
  if (text.size() < header) return std::nullopt;
  const ByteView content = text.subspan(header);
  const auto size =
      request.format.frame == SerialFrame::k1c ? short_content(content) : long_content(content);
  if (!size || content.size() < *size) return std::nullopt;
  request.size = header + *size;
  request.certain = std::ranges::any_of(content.first(*size),
                                        [](std::uint8_t each) { return hex_digit(each) < 0; });
  return request;
}

SeenRequest seen_ascii(ByteView bytes) {
  const bool enclosed = bytes[0] == kStx;  // format 3
  const ByteView text = bytes.subspan(1);
  const auto request = ascii_request(text);
  if (!request || (enclosed && request->format.numbered)) return {};
  const std::size_t summed = request->size + (enclosed ? 1 : 0);
  if (text.size() < summed + 2 || (enclosed && text[summed - 1] != kEtx)) return {};
  if (read_digits(text.subspan(summed, 2)) != sum8(text.first(summed))) return {};
  const std::size_t size = 1 + summed + 2;
  const ByteView rest = bytes.subspan(size);
  const bool line_end = rest.size() >= 2 && rest[0] == '\r' && rest[1] == '\n';
  return {size + (line_end ? 2 : 0), !enclosed || request->certain};
}

SeenRequest seen_binary(ByteView bytes) {
  const Unstuffed frame = unstuffed(bytes);
  const std::size_t header = kCount + header_size({.binary = true});
  if (frame.kind != Unstuffed::Kind::kWhole || bytes.size() < frame.size + 2 ||
      frame.text.size() < header + kCommand)
    return {};
  if (read_digits(bytes.subspan(frame.size, 2)) != sum8(frame.text) ||
      read_number(frame.text, {}, kCount) != frame.text.size() - kCount ||
      read_number(ByteView(frame.text).subspan(header), {}, 2) == 0xFFFF)
    return {};
  return {frame.size + 2, true};
}

}  // namespace

SerialFrame frame_of(ByteView text) {
  const auto identifier = number_at(text, 0, 2);
  return identifier == 0xF8   ? SerialFrame::k4c
         : identifier == 0xF9 ? SerialFrame::k3c
                              : SerialFrame::k1c;
}

std::optional<AsciiRequest> ascii_request(ByteView text) {
  const auto request = request_in(text, false);
  return request ? request : request_in(text, true);
}

SeenRequest seen_serial_request(ByteView bytes) {
  if (bytes.size() < 2) return {};
  if (bytes[0] == kEnq || bytes[0] == kStx) return seen_ascii(bytes);
  return bytes[0] == kDle && bytes[1] == kStx ? seen_binary(bytes) : SeenRequest{};
}

}  // namespace fieldcast::mitsubishi_mc

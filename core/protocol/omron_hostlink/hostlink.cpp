#include "core/protocol/omron_hostlink/hostlink.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"

namespace fieldcast::omron {

namespace {

// `frame` ends before its CR.
ParseResult judged(ByteView frame, std::size_t end) {
  ParseResult parsed{.kind = ParseResult::Kind::kBroken, .end = end};
  const bool last = !frame.empty() && frame.back() == kStar;
  if (last) frame = frame.first(frame.size() - 1);
  if (frame.size() < kFcsSize) return parsed;
  const ByteView text = frame.first(frame.size() - kFcsSize);
  if (read_digits(frame.last(kFcsSize)) != xor8(text)) return parsed;
  return {.kind = ParseResult::Kind::kFrame, .last = last, .text = text, .end = end};
}

}  // namespace

void append_head(Bytes& out, std::uint16_t unit, std::string_view header) {
  out.push_back(kAt);
  append_digits(out, unit, 2, 10);
  out.insert(out.end(), header.begin(), header.end());
}

void append_end(Bytes& out, std::size_t start, bool last) {
  append_digits(out, xor8(ByteView(out).subspan(start)), 2);
  if (last) out.push_back(kStar);
  out.push_back(kCr);
}

ParseResult first_frame(ByteView bytes) {
  const auto at = std::ranges::find(bytes, kAt);
  if (at == bytes.end()) return {};
  const auto cr = std::find(at, bytes.end(), kCr);
  const auto start =
      std::find(std::make_reverse_iterator(cr), std::make_reverse_iterator(at), kAt).base() - 1;
  if (cr == bytes.end()) return {.kind = ParseResult::Kind::kOpen, .text = {start, cr}};
  return judged({start, cr}, static_cast<std::size_t>(cr - bytes.begin()) + 1);
}

ParseResult later_frame(ByteView bytes) {
  if (bytes.empty()) return {};
  const auto cr = std::ranges::find(bytes, kCr);
  if (cr == bytes.end()) return {.kind = ParseResult::Kind::kOpen, .text = bytes};
  return judged({bytes.begin(), cr}, static_cast<std::size_t>(cr - bytes.begin()) + 1);
}

std::string_view end_code_text(std::uint16_t code) {
  const auto text = device_code_text(kEndCodes, code);
  return text.empty() ? "unknown end code" : text;
}

}  // namespace fieldcast::omron

#include "core/protocol/omron_hostlink/hostlink.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"

namespace fieldcast::omron {
namespace {

// `frame` runs up to and without its CR.
Seen judged(ByteView frame, std::size_t end) {
  Seen seen{.kind = Seen::Kind::kBroken, .end = end};
  const bool last = !frame.empty() && frame.back() == kStar;
  if (last) frame = frame.first(frame.size() - 1);
  if (frame.size() < kFcsSize) return seen;
  const ByteView text = frame.first(frame.size() - kFcsSize);
  if (read_digits(frame.last(kFcsSize)) != xor8(text)) return seen;
  return {.kind = Seen::Kind::kFrame, .last = last, .text = text, .end = end};
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

Seen first_frame(ByteView bytes) {
  const auto at = std::find(bytes.begin(), bytes.end(), kAt);
  if (at == bytes.end()) return {};
  const auto cr = std::find(at, bytes.end(), kCr);
  const auto start = std::find(std::make_reverse_iterator(cr), std::make_reverse_iterator(at), kAt).base() - 1;
  if (cr == bytes.end()) return {.kind = Seen::Kind::kOpen, .text = {start, cr}};
  return judged({start, cr}, static_cast<std::size_t>(cr - bytes.begin()) + 1);
}

Seen later_frame(ByteView bytes) {
  if (bytes.empty()) return {};
  const auto cr = std::find(bytes.begin(), bytes.end(), kCr);
  if (cr == bytes.end()) return {.kind = Seen::Kind::kOpen, .text = bytes};
  return judged({bytes.begin(), cr}, static_cast<std::size_t>(cr - bytes.begin()) + 1);
}

std::string_view end_code_text(std::uint16_t code) {
  switch (code) {
    case 0x00: return "normal completion";
    case 0x01: return "not executable in RUN mode";
    case 0x02: return "not executable in MONITOR mode";
    case 0x03: return "program memory protected";
    case 0x04: return "address over";
    case 0x0B: return "not executable in PROGRAM mode";
    case 0x13: return "FCS error";
    case 0x14: return "format error";
    case 0x15: return "entry number data error";
    case 0x16: return "command not supported";
    case 0x18: return "frame length error";
    case 0x19: return "not executable";
    case 0x20: return "I/O table not made";
    case 0x21: return "CPU unit error";
    case 0x23: return "user memory protected";
    case 0xA3: return "aborted: FCS error in the data";
    case 0xA4: return "aborted: format error in the data";
    case 0xA5: return "aborted: entry number error in the data";
    case 0xA8: return "aborted: frame length error in the data";
    default: return "unknown end code";
  }
}

}  // namespace fieldcast::omron

#include "core/protocol/dtc/packet.hpp"

#include <cmath>

#include "core/codec/lzw.hpp"

namespace fieldcast::dtc {

std::size_t auto_threshold(const LineFormat& line, Duration per_byte) {
  // Fraction saved once strings repeat; dtc_bench prints the gain on real data.
  constexpr double kSaved = 0.5;
  constexpr double kLearning = 16.0;  // bytes without a gain
  constexpr double kLengthBytes = 2.0;
  const double character = static_cast<double>(line.characters(1).count());
  const double gain = kSaved * character - static_cast<double>(per_byte.count());
  if (gain <= 0) return kNever;
  const double least = std::ceil((kSaved * kLearning + kLengthBytes) * character / gain);
  return least < static_cast<double>(kNever) ? static_cast<std::size_t>(least) : kNever;
}

void append_packet(Bytes& out, ByteView message, std::size_t threshold) {
  const std::size_t start = out.size();
  // Encoding stops if the body is not at least one byte shorter than the message.
  const std::size_t shorter = message.size() - 1;
  if (message.size() >= threshold && shorter > kOriginalBytes) {
    out.resize(start + kPacketHead + shorter);
    const auto body = std::span(out).subspan(start + kPacketHead);
    LzwEncoder encoder;
    if (const auto codes = encoder.encode(message, body.subspan(kOriginalBytes))) {
      const std::size_t length = kOriginalBytes + *codes;
      out[start] = kCompressed;
      out[start + 1] = static_cast<std::uint8_t>(length >> 8);
      out[start + 2] = static_cast<std::uint8_t>(length);
      body[0] = static_cast<std::uint8_t>(message.size() >> 8);
      body[1] = static_cast<std::uint8_t>(message.size());
      out.resize(start + kPacketHead + length);
      return;
    }
    out.resize(start);
  }
  out.push_back(kPlain);
  append_u16(out, static_cast<std::uint16_t>(message.size()));
  append(out, message);
}

ParseResult parse_packet(ByteView bytes) {
  const std::uint8_t flag = bytes[0];
  if (flag != kPlain && flag != kCompressed) return {};
  ParseResult parsed{.kind = ParseResult::Kind::kOpen,
                     .size = kPacketHead + kMinMessage,
                     .compressed = flag == kCompressed};
  if (bytes.size() < kPacketHead) return parsed;
  const std::size_t length = read_u16(bytes, 1);
  const std::size_t least = parsed.compressed ? kOriginalBytes + 1 : kMinMessage;
  if (length < least || length > kMaxMessage) return {};
  parsed.size = kPacketHead + length;
  const std::size_t head = kPacketHead + (parsed.compressed ? kOriginalBytes : 0);
  if (bytes.size() < head) return parsed;
  parsed.original = parsed.compressed ? read_u16(bytes, kPacketHead) : length;
  if (parsed.compressed && (parsed.original <= length || parsed.original > kMaxMessage)) return {};
  if (bytes.size() < parsed.size) return parsed;
  parsed.kind = ParseResult::Kind::kWhole;
  parsed.content = bytes.subspan(head, parsed.size - head);
  return parsed;
}

}  // namespace fieldcast::dtc

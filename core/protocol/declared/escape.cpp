#include "core/protocol/declared/escape.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace fieldcast::declared {
namespace {

constexpr std::uint8_t kDle = 0x10;
constexpr std::uint8_t kEnd = 0xC0, kEsc = 0xDB, kEscEnd = 0xDC, kEscEsc = 0xDD;
constexpr std::size_t kCobsGroup = 254;  // most bytes behind a code

struct Masking {
  Escape escape;
  std::uint8_t before, inverted, end;
  std::string_view bytes;
  [[nodiscard]] bool holds(std::uint8_t byte) const {
    return bytes.find(static_cast<char>(byte)) != std::string_view::npos;
  }
};
constexpr std::array kMaskings{Masking{Escape::kHdlc, 0x7D, 0x20, 0x7E, "\x7D\x7E"},
                               Masking{Escape::kShdlc, 0x7D, 0x20, 0x7E, "\x7D\x7E\x11\x13"},
                               Masking{Escape::kKmp, 0x1B, 0xFF, 0x0D, "\x1B\x80\x40\x0D\x06"}};

const Masking* masking_of(Escape escape) {
  const auto found = std::ranges::find(kMaskings, escape, &Masking::escape);
  return found == kMaskings.end() ? nullptr : found;
}

Bytes masked(const Masking& masking, ByteView plain) {
  Bytes out;
  for (const std::uint8_t byte : plain) {
    if (masking.holds(byte)) out.push_back(masking.before);
    out.push_back(static_cast<std::uint8_t>(byte ^ (masking.holds(byte) ? masking.inverted : 0)));
  }
  return out;
}

Unescaped from_masked(const Masking& masking, ByteView wire) {
  Unescaped read;
  for (std::size_t& at = read.used; at < wire.size(); ++at) {
    read.ended = wire[at] == masking.end;
    if (read.ended) return read;
    std::uint8_t byte = wire[at];
    if (byte == masking.before) {
      if (at + 1 == wire.size()) return read;
      byte = static_cast<std::uint8_t>(wire[at + 1] ^ masking.inverted);
      read.invalid = !masking.holds(byte);
      if (read.invalid) return read;
      ++at;
    }
    read.plain.push_back(byte);
  }
  return read;
}

Bytes cobs(ByteView plain) {
  Bytes out;
  for (std::size_t at = 0;;) {
    const auto rest = plain.subspan(at, std::min(kCobsGroup, plain.size() - at));
    const auto size = static_cast<std::size_t>(std::ranges::find(rest, 0) - rest.begin());
    out.push_back(static_cast<std::uint8_t>(size + 1));
    append(out, rest.first(size));
    at += size;
    if (size == kCobsGroup && at < plain.size()) continue;
    if (at >= plain.size()) return out;
    ++at;  // the zero
  }
}

Unescaped from_cobs(ByteView wire) {
  Unescaped read;
  const auto end = std::ranges::find(wire, 0);
  read.ended = end != wire.end();
  read.used = static_cast<std::size_t>(end - wire.begin());
  for (std::size_t at = 0; at < read.used;) {
    const std::size_t size = wire[at] - 1u;
    const std::size_t here = std::min(size, read.used - at - 1);
    append(read.plain, wire.subspan(at + 1, here));
    at += here + 1;
    if (here < size) read.invalid = read.ended;
    if (here == size && size < kCobsGroup && at < read.used) read.plain.push_back(0);
  }
  return read;
}

}  // namespace

Bytes escaped(Escape escape, ByteView plain) {
  if (escape == Escape::kCobs) return cobs(plain);
  if (const Masking* masking = masking_of(escape)) return masked(*masking, plain);
  Bytes out;
  for (const std::uint8_t byte : plain) {
    if (escape == Escape::kDle && byte == kDle) out.push_back(kDle);
    if (escape == Escape::kSlip && (byte == kEnd || byte == kEsc)) {
      append(out, Bytes{kEsc, byte == kEnd ? kEscEnd : kEscEsc});
      continue;
    }
    out.push_back(byte);
  }
  return out;
}

Unescaped unescape(Escape escape, ByteView wire) {
  if (escape == Escape::kCobs) return from_cobs(wire);
  if (const Masking* masking = masking_of(escape)) return from_masked(*masking, wire);
  Unescaped read;
  for (std::size_t& at = read.used; at < wire.size(); ++at) {
    const std::uint8_t byte = wire[at];
    read.ended = escape == Escape::kSlip && byte == kEnd;
    if (read.ended) return read;
    const bool begins = byte == (escape == Escape::kSlip ? kEsc : kDle) && escape != Escape::kNone;
    if (!begins) {
      read.plain.push_back(byte);
      continue;
    }
    if (at + 1 == wire.size()) return read;
    const std::uint8_t next = wire[at + 1];
    if (escape == Escape::kDle && next != kDle) {
      read.ended = true;
      return read;
    }
    if (escape == Escape::kSlip && next != kEscEnd && next != kEscEsc) {
      read.invalid = true;
      return read;
    }
    read.plain.push_back(escape == Escape::kDle ? kDle : next == kEscEnd ? kEnd : kEsc);
    ++at;
  }
  return read;
}

}  // namespace fieldcast::declared

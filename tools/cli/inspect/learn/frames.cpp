#include "tools/cli/inspect/learn/frames.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/codec/digits.hpp"

namespace fieldcast::learn {

std::optional<std::uint8_t> byte_at(ByteView frame, std::ptrdiff_t at) {
  const auto size = static_cast<std::ptrdiff_t>(frame.size());
  if (at < 0) at += size;
  if (at < 0 || at >= size) return std::nullopt;
  return frame[static_cast<std::size_t>(at)];
}

std::optional<std::uint64_t> number_at(ByteView frame, std::ptrdiff_t at,
                                       const declared::Word& word) {
  const auto size = static_cast<std::ptrdiff_t>(frame.size());
  if (at < 0) at += size;
  if (at < 0 || at + word.characters > size) return std::nullopt;
  return declared::read_word(frame.subspan(static_cast<std::size_t>(at), word.characters), word);
}

std::set<std::uint8_t> values_at(const Frames& frames, std::ptrdiff_t at) {
  std::set<std::uint8_t> values;
  for (const ByteView frame : frames) {
    if (const auto byte = byte_at(frame, at)) values.insert(*byte);
  }
  return values;
}

std::optional<std::uint8_t> constant_at(const Frames& frames, std::ptrdiff_t at) {
  std::array<std::size_t, 256> counts{};
  Evidence best;
  std::uint8_t value = 0;
  for (const ByteView frame : frames) {
    const auto byte = byte_at(frame, at);
    if (!byte) continue;
    ++best.of;
    if (++counts[*byte] > best.holds) best.holds = counts[*byte], value = *byte;
  }
  return best.holds_mostly() ? std::optional(value) : std::nullopt;
}

std::size_t constant_end(const Frames& frames, std::size_t most) {
  std::size_t size = 0;
  most = std::min(most, shortest(frames));
  while (size < most && constant_at(frames, -1 - static_cast<std::ptrdiff_t>(size))) ++size;
  return size;
}

std::size_t shortest(const Frames& frames) {
  return frames.empty() ? 0 : std::ranges::min(frames, {}, &ByteView::size).size();
}
std::size_t longest(const Frames& frames) {
  return frames.empty() ? 0 : std::ranges::max(frames, {}, &ByteView::size).size();
}

bool is_text(const Frames& frames) {
  // STX, ETX, EOT, ENQ, ACK, TAB, LF, CR, NAK, ETB.
  static constexpr std::string_view kMarks = "\x02\x03\x04\x05\x06\x09\x0A\x0D\x15\x17";
  Evidence text;
  for (const ByteView frame : frames) {
    ++text.of;
    const auto others = std::ranges::count_if(frame, [](std::uint8_t c) {
      return (c < ' ' || c > '~') && kMarks.find(static_cast<char>(c)) == kMarks.npos;
    });
    // A checksum may be any byte, also in a text.
    if (static_cast<std::size_t>(others) <= frame.size() / 16) ++text.holds;
  }
  return text.holds_mostly();
}

}  // namespace fieldcast::learn

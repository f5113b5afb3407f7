#include "tools/cli/inspect/learn/frames.hpp"

#include <algorithm>
#include <map>
#include <string_view>

#include "core/codec/digits.hpp"

namespace fieldcast::learn {

ByteView columns_of(ByteView frame, std::ptrdiff_t at, std::size_t width) {
  if (at < 0) at += static_cast<std::ptrdiff_t>(frame.size());
  const bool inside = at >= 0 && static_cast<std::size_t>(at) + width <= frame.size();
  return inside ? frame.subspan(static_cast<std::size_t>(at), width) : ByteView{};
}

std::optional<std::uint8_t> byte_at(ByteView frame, std::ptrdiff_t at) {
  const ByteView byte = columns_of(frame, at, 1);
  return byte.empty() ? std::nullopt : std::optional(byte.front());
}

std::optional<std::uint64_t> number_at(ByteView frame, std::ptrdiff_t at,
                                       const declared::Word& word) {
  const ByteView characters = columns_of(frame, at, word.characters);
  return characters.empty() ? std::nullopt : declared::read_word(characters, word);
}

std::set<std::uint8_t> values_in(const Frames& frames, std::ptrdiff_t at, std::ptrdiff_t end) {
  std::set<std::uint8_t> values;
  for (const ByteView frame : frames) {
    const auto size = static_cast<std::ptrdiff_t>(frame.size());
    for (std::ptrdiff_t i = at; i < (at >= 0 && end <= 0 ? end + size : end); ++i) {
      if (const auto byte = byte_at(frame, i)) values.insert(*byte);
    }
  }
  return values;
}

std::size_t different(const Frames& frames, std::ptrdiff_t at, std::ptrdiff_t end) {
  std::set<Bytes> values;
  for (const ByteView frame : frames) {
    const ByteView value = columns_of(frame, at, static_cast<std::size_t>(end - at));
    values.emplace(value.begin(), value.end());
  }
  return values.size();
}

std::optional<std::uint8_t> constant_at(const Frames& frames, std::ptrdiff_t at) {
  std::map<std::uint8_t, std::size_t> counts;
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
    const auto others = std::ranges::count_if(frame, [](std::uint8_t c) {
      return (c < ' ' || c > '~') && kMarks.find(static_cast<char>(c)) == kMarks.npos;
    });
    // A checksum may be any byte, also in a text.
    text.add(static_cast<std::size_t>(others) <= frame.size() / 16);
  }
  return text.holds_mostly();
}

bool are_digits(const Frames& frames, std::ptrdiff_t at, std::ptrdiff_t end, int base) {
  return std::ranges::all_of(values_in(frames, at, end), [&](std::uint8_t c) {
    return hex_digit(c) >= 0 && hex_digit(c) < base;
  });
}

std::set<std::uint8_t> packed_adds(const std::set<std::uint8_t>& values) {
  std::set<std::uint8_t> fits;
  for (unsigned add = 0; add < 256; ++add) {
    const auto is_packed = [&](std::uint8_t byte) {
      const auto digits = static_cast<std::uint8_t>(byte - add);
      return digits >> 4 <= 9 && (digits & 0xFu) <= 9;
    };
    if (std::ranges::all_of(values, is_packed)) fits.insert(static_cast<std::uint8_t>(add));
  }
  return fits;
}

declared::Word word_at(const Frames& frames, std::ptrdiff_t at, std::size_t width, bool text) {
  if (!text) return binary(std::min<std::size_t>(width, 8));
  const bool decimal = are_digits(frames, at, at + static_cast<std::ptrdiff_t>(width), 10);
  return decimal ? digits(declared::Notation::kDecimal, std::min<std::size_t>(width, 18))
                 : digits(declared::Notation::kHex, std::min<std::size_t>(width, 16));
}

}  // namespace fieldcast::learn

#include "tools/sim/families/dtc_lzw.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

namespace fieldcast::sim {
namespace {

constexpr unsigned kFull = 4096;

int bits_of_code(unsigned k) { return std::bit_width(std::min(15 + k, kFull - 1)); }

}  // namespace

Bytes dtc_compress(ByteView message) {
  // (code of a string, next nibble) -> code of the longer string.
  std::map<std::pair<unsigned, unsigned>, unsigned> longer;
  Bytes out;
  unsigned next = 16, k = 0, room = 0;
  const auto emit = [&](unsigned code) {
    for (int bit = bits_of_code(k++) - 1; bit >= 0; --bit) {
      if (room == 0) out.push_back(0), room = 8;
      --room;
      out.back() = static_cast<std::uint8_t>(out.back() | (code >> bit & 1u) << room);
    }
  };
  std::optional<unsigned> string;
  for (std::size_t i = 0; i < 2 * message.size(); ++i) {
    const unsigned nibble = i % 2 == 0 ? message[i / 2] >> 4 : message[i / 2] & 15u;
    if (!string) {
      string = nibble;
    } else if (const auto found = longer.find({*string, nibble}); found != longer.end()) {
      string = found->second;
    } else {
      emit(*string);
      if (next < kFull) longer[{*string, nibble}] = next++;
      string = nibble;
    }
  }
  if (string) emit(*string);
  return out;
}

std::optional<Bytes> dtc_expand(ByteView codes, std::size_t length) {
  struct Entry {
    unsigned before;
    std::uint8_t last, first;
    unsigned size;
  };
  std::vector<Entry> entries;
  for (unsigned n = 0; n < 16; ++n)
    entries.push_back({0, static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n), 1});
  Bytes nibbles;
  std::size_t bit = 0;
  unsigned previous = 0;
  for (unsigned k = 0; nibbles.size() < 2 * length; ++k) {
    unsigned code = 0;
    for (int n = bits_of_code(k); n > 0; --n, ++bit) {
      if (bit / 8 >= codes.size()) return std::nullopt;
      code = code << 1 | (codes[bit / 8] >> (7 - bit % 8) & 1u);
    }
    // The encoder's last entry: the previous string and the first nibble of this one.
    if (k > 0 && entries.size() < kFull) {
      if (code > entries.size()) return std::nullopt;
      const Entry head = entries[previous];
      const std::uint8_t first = code < entries.size() ? entries[code].first : head.first;
      entries.push_back({previous, first, head.first, head.size + 1});
    }
    if (code >= entries.size() || entries[code].size > 2 * length - nibbles.size())
      return std::nullopt;
    nibbles.resize(nibbles.size() + entries[code].size);
    unsigned string = code;
    for (auto at = nibbles.end(); true; string = entries[string].before) {
      *--at = entries[string].last;
      if (entries[string].size == 1) break;
    }
    previous = code;
  }
  Bytes out;
  for (std::size_t i = 0; i < nibbles.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(nibbles[i] << 4 | nibbles[i + 1]));
  return out;
}

}  // namespace fieldcast::sim

#include "tests/core/lzw_reference.hpp"

#include <map>

namespace fieldcast::test {
namespace {

constexpr std::size_t kEntries = 4096;

std::size_t bit_length(std::size_t value) {
  std::size_t bits = 0;
  for (; value > 0; value /= 2) ++bits;
  return bits;
}
std::size_t width(std::size_t k) { return bit_length(std::min<std::size_t>(15 + k, kEntries - 1)); }

std::string nibbles_of(ByteView bytes) {
  std::string nibbles;
  for (const auto byte : bytes)
    nibbles += {static_cast<char>(byte / 16), static_cast<char>(byte % 16)};
  return nibbles;
}

}  // namespace

std::vector<unsigned> reference_codes(ByteView original) {
  std::map<std::string, unsigned> dictionary;
  for (unsigned nibble = 0; nibble < 16; ++nibble)
    dictionary[std::string(1, static_cast<char>(nibble))] = nibble;
  std::vector<unsigned> codes;
  std::string string;
  for (const char nibble : nibbles_of(original)) {
    const std::string longer = string + nibble;
    if (dictionary.contains(longer)) {
      string = longer;
      continue;
    }
    codes.push_back(dictionary.at(string));
    const auto number = static_cast<unsigned>(dictionary.size());
    if (number < kEntries) dictionary[longer] = number;
    string = std::string(1, nibble);
  }
  if (!string.empty()) codes.push_back(dictionary.at(string));
  return codes;
}

Bytes packed(const std::vector<unsigned>& codes) {
  Bytes bytes;
  std::size_t bits = 0;
  for (std::size_t k = 0; k < codes.size(); ++k) {
    for (std::size_t bit = width(k); bit-- > 0; ++bits) {
      if (bits % 8 == 0) bytes.push_back(0);
      if ((codes[k] >> bit & 1u) != 0)
        bytes.back() = static_cast<std::uint8_t>(bytes.back() | 0x80u >> bits % 8);
    }
  }
  return bytes;
}

std::optional<Bytes> reference_decode(ByteView bytes, std::size_t length) {
  std::vector<std::string> dictionary;
  for (char nibble = 0; nibble < 16; ++nibble) dictionary.emplace_back(1, nibble);
  std::string out, before;
  std::size_t bits = 0;
  for (std::size_t k = 0; out.size() < 2 * length; ++k) {
    std::size_t code = 0;
    for (std::size_t bit = 0; bit < width(k); ++bit, ++bits) {
      if (bits / 8 >= bytes.size()) return std::nullopt;
      code = 2 * code + (bytes[bits / 8] >> (7 - bits % 8) & 1u);
    }
    std::string string;
    if (code < dictionary.size()) {
      string = dictionary[code];
    } else if (k > 0 && code == dictionary.size() && code < kEntries) {
      string = before + before[0];
    } else {
      return std::nullopt;
    }
    if (k > 0 && dictionary.size() < kEntries) dictionary.push_back(before + string[0]);
    if (string.size() > 2 * length - out.size()) return std::nullopt;
    out += before = string;
  }
  Bytes original;
  for (std::size_t i = 0; i < out.size(); i += 2)
    original.push_back(static_cast<std::uint8_t>(out[i] * 16 + out[i + 1]));
  return original;
}

}  // namespace fieldcast::test

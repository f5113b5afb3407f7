#include "core/codec/raw_items.hpp"

#include <algorithm>
#include <cstdlib>

namespace fieldcast {
namespace {

constexpr std::size_t kMaxBytes = 8;

// Bit items contain a number with its least significant bit first, as coils do.
std::uint64_t from_bit_items(ByteView items, std::size_t count) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) bits |= static_cast<std::uint64_t>(items[i] != 0) << i;
  return bits;
}

// Works in both directions: each half is its own inverse, and they commute.
void reorder(const Encoding& encoding, std::span<std::uint8_t> bytes) {
  if (bytes.size() < 2) return;
  if (encoding.word_order == WordOrder::kLittleEndian) {
    for (std::size_t low = 0, high = bytes.size() - 2; low < high; low += 2, high -= 2) {
      std::swap(bytes[low], bytes[high]);
      std::swap(bytes[low + 1], bytes[high + 1]);
    }
  }
  if (encoding.byte_order == ByteOrder::kLittleEndian) {
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
  }
}

void swap_pairs(const Encoding& encoding, Bytes& bytes) {
  if (encoding.byte_order != ByteOrder::kLittleEndian) return;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
}

std::uint8_t filler(const Encoding& encoding, std::uint64_t bits) {
  const bool negative = is_signed(encoding.type) && (bits >> (width_bits(encoding) - 1) & 1u) != 0;
  return negative ? 0xFF : 0x00;
}

}  // namespace

tl::expected<std::uint64_t, Cause> gather_bits(const Encoding& encoding, unsigned item_bits,
                                               ByteView items) {
  const std::uint32_t count = value_items(encoding, item_bits);
  // REQUIRES of decode_value.
  if (items.size() < (item_bits <= 8 ? count : count * (item_bits / 8))) std::abort();
  if (item_bits == 1) return from_bit_items(items, count);

  const std::size_t width = width_bits(encoding) / 8;
  const std::size_t image = count * (item_bits / 8);
  if (is_part(encoding, item_bits)) return items[image - 1 - *encoding.bit / 8];
  const std::size_t spare = image - width;  // above 0 only if one item is wider than the value
  std::uint8_t bytes[kMaxBytes];
  std::copy_n(items.begin() + static_cast<std::ptrdiff_t>(spare), width, bytes);
  reorder(encoding, {bytes, width});
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < width; ++i) bits = bits << 8 | bytes[i];
  const std::uint8_t fill = filler(encoding, bits);
  for (std::size_t i = 0; i < spare; ++i) {
    if (items[i] != fill) return tl::unexpected(Cause::kRange);
  }
  return bits;
}

Bytes spread_bits(const Encoding& encoding, unsigned item_bits, std::uint64_t bits) {
  const std::uint32_t count = value_items(encoding, item_bits);
  if (item_bits == 1) {
    Bytes items(count);
    for (std::uint32_t i = 0; i < count; ++i) items[i] = static_cast<std::uint8_t>(bits >> i & 1u);
    return items;
  }
  const std::size_t width = width_bits(encoding) / 8;
  if (is_part(encoding, item_bits)) {
    Bytes item(item_bits / 8, 0);
    item[item.size() - 1 - *encoding.bit / 8] = static_cast<std::uint8_t>(bits);
    return item;
  }
  Bytes items(count * (item_bits / 8), filler(encoding, bits));
  const std::span<std::uint8_t> value = std::span{items}.last(width);
  for (std::size_t i = 0; i < width; ++i)
    value[i] = static_cast<std::uint8_t>(bits >> (8 * (width - 1 - i)));
  reorder(encoding, value);
  return items;
}

Bytes string_bytes_of(const Encoding& encoding, unsigned item_bits, ByteView items) {
  Bytes text;
  if (item_bits == 1) {
    for (std::size_t i = 0; i + 8 <= items.size(); i += 8) {
      text.push_back(static_cast<std::uint8_t>(from_bit_items(items.subspan(i, 8), 8)));
    }
  } else {
    text.assign(items.begin(), items.end());
  }
  swap_pairs(encoding, text);
  if (text.size() < width_bits(encoding) / 8) std::abort();  // see REQUIRES of decode_value()
  if (encoding.layout == TextLayout::kCounted) {
    const std::size_t length = std::min<std::size_t>(text[1], encoding.string_bytes);
    return {text.begin() + 2, text.begin() + 2 + static_cast<std::ptrdiff_t>(length)};
  }
  text.resize(width_bits(encoding) / 8);
  return text;
}

Bytes items_of_string(const Encoding& encoding, unsigned item_bits, ByteView text) {
  const std::uint32_t count = value_items(encoding, item_bits);
  Bytes bytes(text.begin(), text.end());
  bytes.resize(item_bits == 1 ? count / 8 : count * (item_bits / 8), 0);
  swap_pairs(encoding, bytes);
  if (item_bits != 1) return bytes;
  Bytes items;
  items.reserve(count);
  for (const std::uint8_t byte : bytes) {
    for (unsigned bit = 0; bit < 8; ++bit)
      items.push_back(static_cast<std::uint8_t>(byte >> bit & 1u));
  }
  return items;
}

}  // namespace fieldcast

// Values in a block of lines (IEC 62056-21), of M-Bus data records (EN 13757-3) or of tags.
#include <algorithm>

#include "core/codec/digits.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::declared {
namespace {

constexpr std::uint8_t kFiller = 0x2F, kExtended = 0x80, kPlainTextUnit = 0x7C;

// Bytes of the data of a record; empty if it has no end (manufacturer data, an invalid length).
std::optional<std::size_t> record_size(ByteView data, std::uint8_t dif) {
  static constexpr std::uint8_t kSizes[] = {0, 1, 2, 3, 4, 4, 6, 8, 0, 1, 2, 3, 4, 0, 6, 0};
  if ((dif & 0x0F) == 0x0F) return std::nullopt;
  if ((dif & 0x0F) != 0x0D) return kSizes[dif & 0x0F];
  if (data.empty()) return std::nullopt;
  const unsigned length = data[0];  // LVAR
  if (length < 0xC0) return 1 + length;
  if (length < 0xF0) return 1 + (length & 0x0F);
  return std::nullopt;
}

// The length and the characters of a unit in plain text; 0 if the bytes do not begin with one.
std::size_t unit_size(ByteView bytes) {
  if (bytes.empty() || bytes[0] == 0 || bytes[0] >= bytes.size()) return 0;
  const bool printable =
      std::ranges::all_of(bytes.subspan(1, bytes[0]), [](auto c) { return c >= ' '; });
  return printable ? 1u + bytes[0] : 0;
}

std::optional<ByteView> record_in(ByteView block, const Field& field) {
  std::size_t at = 0;
  const auto skip_extensions = [&] {
    while (at < block.size() && (block[at] & kExtended) != 0) ++at;
    ++at;
  };
  while (at < block.size()) {
    const std::size_t begin = at;
    const std::uint8_t dif = block[at];
    if (dif == kFiller) {
      ++at;
      continue;
    }
    skip_extensions();
    if (at >= block.size()) return std::nullopt;
    const std::uint8_t vif = block[at++];
    const ByteView head = block.subspan(begin, at - begin);
    const bool plain = (vif & 0x7F) == kPlainTextUnit;
    // The unit is behind the extensions of the VIF, and in older meters before them.
    const std::size_t unit = plain ? unit_size(block.subspan(at)) : 0;
    at += unit;
    const std::size_t extensions = at;
    if ((vif & kExtended) != 0) skip_extensions();
    if (at > block.size()) return std::nullopt;
    Bytes header(head.begin(), head.end());
    append(header, block.subspan(extensions, at - extensions));
    if (plain && unit == 0) at += at < block.size() ? 1u + block[at] : 1u;
    if (at > block.size()) return std::nullopt;
    const auto size = record_size(block.subspan(at), dif);
    if (!size || *size > block.size() - at) return std::nullopt;
    const bool same = std::ranges::equal(header, field.key, {}, {},
                                         [](char c) { return static_cast<std::uint8_t>(c); });
    if (same)
      return *size == field.word.characters ? std::optional(block.subspan(at, *size))
                                            : std::nullopt;
    at += *size;
  }
  return std::nullopt;
}

bool has_key(ByteView bytes, const Field& field) {
  return bytes.size() >= field.key.size() &&
         std::ranges::equal(bytes.first(field.key.size()), field.key, {}, {},
                            [](char c) { return static_cast<std::uint8_t>(c); });
}

// Ends at a tag without a field, as its length is unknown.
std::optional<ByteView> tagged_in(const Frame& frame, std::size_t index, ByteView block) {
  const bool counted = frame.block == Block::kTagLengthValue;
  const Field& wanted = frame.fields[index];
  std::size_t first = index;
  while (!opens_block(frame, first)) --first;
  const std::span fields(frame.fields.data() + first, block_end(frame, first) - first);
  while (!block.empty()) {
    const auto field =
        std::ranges::find_if(fields, [&](const Field& each) { return has_key(block, each); });
    if (field == fields.end() && !counted) return std::nullopt;
    // All tags have one size if a length follows them.
    const std::size_t header = counted ? wanted.key.size() + 1 : field->key.size();
    if (header > block.size()) return std::nullopt;
    const std::size_t size = counted                 ? block[header - 1]
                             : field->text_size != 0 ? field->text_size
                                                     : field->word.characters;
    block = block.subspan(header);
    if (size > block.size()) return std::nullopt;
    if (field != fields.end() && &*field == &wanted) {
      const bool fits =
          wanted.text_size != 0 ? size <= wanted.text_size : size == wanted.word.characters;
      return fits ? std::optional(block.first(size)) : std::nullopt;
    }
    block = block.subspan(size);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ByteView> value_in_block(const Frame& frame, std::size_t at, ByteView block) {
  const Field& field = frame.fields[at];
  if (frame.block != Block::kRecords) return tagged_in(frame, at, block);
  if (field.text_size == 0) return record_in(block, field);
  const auto same = [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); };
  for (auto from = block.begin();; ++from) {
    from = std::search(from, block.end(), field.key.begin(), field.key.end(), same);
    if (from == block.end()) return std::nullopt;
    // 1.8.0 is not the end of 11.8.0.
    const std::uint8_t before = from == block.begin() ? 0 : from[-1];
    const bool whole = before != '.' && hex_digit(before) < 0;
    if (!whole) continue;
    auto begin = from + static_cast<std::ptrdiff_t>(field.key.size());
    if (!field.after.empty()) {
      const auto line = std::find(begin, block.end(), std::uint8_t{'\n'});
      begin = std::search(begin, line, field.after.begin(), field.after.end(), same);
      if (begin == line) return std::nullopt;
      begin += static_cast<std::ptrdiff_t>(field.after.size());
    }
    const auto end = std::search(begin, block.end(), field.until.begin(), field.until.end(), same);
    if (end == block.end() || end - begin > field.text_size) return std::nullopt;
    return ByteView(begin, end);
  }
}

}  // namespace fieldcast::declared

// Writes a declared frame, and matches one at the start of untrusted bytes. Pure functions.
#pragma once

#include <cstdint>
#include <optional>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::declared {

struct FrameContext {
  std::uint64_t address = 0;
  std::uint64_t command = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint16_t sequence = 0;
  std::optional<std::uint64_t> rate{};  // code of the baud rate that the device has named
  unsigned item_bits = 16;
  // `items` are known: they are sent, and an echoing response must contain them.
  bool written = false;
  bool refusal = false;  // the frame is a refusal: its error field must contain an error
  Bytes items;           // the image of first .. first+count-1
};

// Fields from .. to-1; a variable text counts with its maximum.
[[nodiscard]] std::size_t size_of(const Frame& frame, std::size_t from, std::size_t to,
                                  unsigned item_bits, std::uint32_t count);
[[nodiscard]] inline std::size_t size_of(const Frame& frame, unsigned item_bits,
                                         std::uint32_t count) {
  return size_of(frame, 0, frame.fields.size(), item_bits, count);
}

void append_frame(Bytes& out, const Frame& frame, const FrameContext& context);

struct MatchResult {
  enum class Fit : std::uint8_t {
    kNone,   // not this frame
    kPart,   // matches so far; at most `missing` characters are missing
    kWhole,  // this frame, of `size` characters
  };
  Fit fit = Fit::kNone;
  std::size_t size = 0;
  std::size_t missing = 0;
  std::size_t known = 0;  // received fields that have only one possible value
  bool foreign = false;   // from another device, or for another request
  bool mismatch = false;  // an unexpected length, count or echo
  bool bad_check = false;
  bool checked = false;  // the frame has a checksum
  std::uint16_t error = 0;
  std::optional<std::uint64_t> rate;  // of a rate field
  std::vector<Range> absent;          // items of the record whose values the block does not contain
  Bytes items;                        // of kItems, or the record with all its values
};
// `record_items`: size of the record that the values fill; 0 if none.
[[nodiscard]] MatchResult match_frame(const Frame& frame, ByteView bytes,
                                      const FrameContext& context, std::size_t record_items);

// Empty if the response may contain any number.
[[nodiscard]] std::optional<std::uint64_t> number_of(const Field& field,
                                                     const FrameContext& context);

// What a length counts of one field of so many characters; see Counts.
[[nodiscard]] std::uint64_t counted(const Field& field, const Field& length, std::size_t characters,
                                    unsigned item_bits);
// The inverse: characters of a field with this count.
[[nodiscard]] std::size_t characters_of_count(const Field& field, const Field& length,
                                              std::uint64_t count, unsigned item_bits);

[[nodiscard]] Bytes covered(const Frame& frame, const Field& sum, ByteView bytes,
                            std::span<const std::size_t> starts);

// Replaces the escaped fields, which begin at `offset`, by what they represent. Empty if invalid.
[[nodiscard]] std::optional<Unescaped> unescape_from(const Frame& frame, std::size_t offset,
                                                     ByteView bytes, Bytes& plain);

// The characters of a constant, without its transform. REQUIRES: it shares no byte.
[[nodiscard]] Bytes constant_characters(const Field& constant);

// The constant behind the variable text `at`, with only fields in digits between them, which cannot
// contain it. Empty if there is none.
[[nodiscard]] std::optional<std::size_t> mark_behind(const Frame& frame, std::size_t at);

// The characters of the value of the field `at` in its block; empty if the block does not contain
// it.
[[nodiscard]] std::optional<ByteView> value_in_block(const Frame& frame, std::size_t at,
                                                     ByteView block);
[[nodiscard]] inline bool opens_block(const Frame& frame, std::size_t at) {
  return !frame.fields[at].key.empty() && (at == 0 || frame.fields[at - 1].key.empty());
}
// The field behind the block that begins at `at`.
[[nodiscard]] inline std::size_t block_end(const Frame& frame, std::size_t at) {
  while (at < frame.fields.size() && !frame.fields[at].key.empty()) ++at;
  return at;
}

// Empty if a character is invalid. `characters`: without separators; of variable width: one item.
void append_items(Bytes& out, const Field& field, unsigned item_bits, ByteView items);
[[nodiscard]] std::optional<Bytes> read_items(ByteView characters, const Field& field,
                                              unsigned item_bits, std::uint32_t count);
[[nodiscard]] std::size_t items_size(const Field& field, unsigned item_bits, std::uint32_t count);

// `at`: first 16-bit item.
[[nodiscard]] std::uint64_t value_in(ByteView image, std::size_t at, std::size_t items);
[[nodiscard]] constexpr std::uint16_t items_of(const Field& value) {
  return static_cast<std::uint16_t>(value.scaled()                ? kScaledCharacters / 2
                                    : value.text_size != 0        ? (value.text_size + 1) / 2
                                    : (value.bits + 15) / 16 == 3 ? 4
                                                                  : (value.bits + 15) / 16);
}

}  // namespace fieldcast::declared

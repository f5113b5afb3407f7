// Writes a declared frame, and recognises one at the start of hostile bytes. Pure functions.
#pragma once

#include <cstdint>
#include <optional>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::declared {

// What the fields of a frame mean in one exchange: the context in which it is written or matched.
struct FrameContext {
  std::uint16_t address = 0;
  std::uint64_t command = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint16_t sequence = 0;
  unsigned item_bits = 16;
  // `items` are known: what is written, and what an answer that repeats them must show.
  bool written = false;
  bool refusal = false;  // the frame is a refusal: its error field must tell one
  Bytes items;           // the image of first .. first+count-1
};

// Characters of the fields from .. to-1 with `count` items; a variable text counts in full.
[[nodiscard]] std::size_t size_of(const Frame& frame, std::size_t from, std::size_t to,
                                  unsigned item_bits, std::uint32_t count);
[[nodiscard]] inline std::size_t size_of(const Frame& frame, unsigned item_bits,
                                         std::uint32_t count) {
  return size_of(frame, 0, frame.fields.size(), item_bits, count);
}

void append_frame(Bytes& out, const Frame& frame, const FrameContext& context);

// How a frame matches the start of some bytes.
struct MatchResult {
  enum class Fit : std::uint8_t {
    kNone,   // not this frame
    kPart,   // this frame so far; `missing` characters at most lack
    kWhole,  // this frame, of `size` characters
  };
  Fit fit = Fit::kNone;
  std::size_t size = 0;
  std::size_t missing = 0;
  std::size_t known = 0;  // fields that had come and had only one possible value
  bool foreign = false;   // of another device, or to another request
  bool mismatch = false;  // a length, count or echo that is not ours
  bool bad_check = false;
  bool checked = false;  // it has a checksum
  std::uint16_t error = 0;
  Bytes items;  // of kItems, or the record with all its values
};
// `record_items`: of the record that the values fill; 0 where there is none.
[[nodiscard]] MatchResult match_frame(const Frame& frame, ByteView bytes,
                                      const FrameContext& context, std::size_t record_items);

// The number that a field must show; nothing for what an answer is free to say.
[[nodiscard]] std::optional<std::uint64_t> number_of(const Field& field,
                                                     const FrameContext& context);

// The characters that a checksum is taken over.
[[nodiscard]] Bytes covered(const Frame& frame, const Field& sum, ByteView bytes,
                            std::span<const std::size_t> starts);

// Items as characters of an items field, and back; nothing when a character is none that an item
// can have.
void append_items(Bytes& out, const Field& field, unsigned item_bits, ByteView items);
[[nodiscard]] std::optional<Bytes> read_items(ByteView characters, const Field& field,
                                              unsigned item_bits, std::uint32_t count);
[[nodiscard]] std::size_t items_size(const Field& field, unsigned item_bits, std::uint32_t count);

// A value's number in the image of its record, 16-bit items from `at`.
[[nodiscard]] std::uint64_t value_in(ByteView image, std::size_t at, std::size_t items);
[[nodiscard]] constexpr std::uint16_t items_of(const Field& value) {
  return static_cast<std::uint16_t>(value.text_size != 0          ? (value.text_size + 1) / 2
                                    : (value.bits + 15) / 16 == 3 ? 4
                                                                  : (value.bits + 15) / 16);
}

}  // namespace fieldcast::declared

// A device family described by data: its areas, and for each operation the frames of request and
// answer cut into fields. The loader (config/declaration.hpp) makes it from a text and has checked
// all that is said here under REQUIRES; DeclaredProtocol speaks it.
//
//     Declaration > Operation > Frame > Field
//
// Plain values, shared and never changed once made. Any thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/protocol/declared/check.hpp"
#include "core/protocol/declared/word.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/seen_request.hpp"

namespace fieldcast::declared {

inline constexpr std::size_t kMaxFields = 64;      // of a frame
inline constexpr std::size_t kMaxOperations = 64;  // of a declaration
// Characters of a frame, whatever its own length says.
inline constexpr std::size_t kMaxFrame = 1024;

enum class FieldKind : std::uint8_t {
  kConstant,  // always `number`, or the characters of `text`
  kAddress,   // of the device
  kCommand,   // of the operation, plus `plus`
  kFirst,     // first item of the range * times + plus
  kCount,     // items of the range * times + plus
  kLength,    // bytes (or characters) of the fields `of`, plus `plus`
  kItems,     // the range's items
  kValue,     // a place of a record, by name
  kChecksum,  // over the fields `of`
  kError,     // a device's code: in an answer it must be `number`, in a refusal it must not
  kSequence,  // counts exchanges; the answer repeats it
  kUnused,    // `number` in what is sent, anything in what comes
};

// From one field to another of the same frame, both included.
struct Span {
  std::uint8_t from = 0, to = 0;
  [[nodiscard]] bool holds(std::size_t field) const { return field >= from && field <= to; }
  friend bool operator==(const Span&, const Span&) = default;
};

// Fields narrower than their word share it: the first of them carries the word's characters, all of
// them the same `word`.
struct Field {
  std::string name;
  FieldKind kind = FieldKind::kConstant;
  Word word;  // how the number stands on the wire; of items: one item, or one byte of packed bits
  std::uint8_t bits = 8;       // 1..64, of this field's number
  std::uint8_t shift = 0;      // of its lowest bit in the word
  bool opens = true;           // first of its word
  bool is_signed = false;      // a value narrower than its items is extended by its sign
  bool in_characters = false;  // a length counts characters, not bytes
  // A text that may be shorter: up to the constant behind it, or as a length says.
  bool variable = false;
  std::uint16_t text_size = 0;  // characters of a value that is a text, at most
  TextNumber text_number = {};  // the number that the text spells; none: it is a text
  std::string text;             // of a constant that is one
  std::uint64_t number = 0;
  std::uint32_t times = 1;
  std::int64_t plus = 0;
  Span of;
  Check check;
  std::uint64_t on = 1, off = 0;  // how a bit stands in a word of its own
  bool packed = false;            // eight bit items in a byte, the first lowest
  std::uint16_t place = 0;        // of a value: its first item in the record
  friend bool operator==(const Field&, const Field&) = default;
};

struct Frame {
  std::vector<Field> fields;
  friend bool operator==(const Frame&, const Frame&) = default;
};

// A named place of a record: `items` 16-bit items from `first`, a number of `bits` or a text.
struct Place {
  std::string name;
  std::uint16_t first = 0, items = 1;
  std::uint8_t bits = 16;        // 0: a text
  bool is_signed = false;        // a number narrower than its items is extended by its sign
  std::uint16_t characters = 0;  // of a text
  TextNumber text_number = {};
  friend bool operator==(const Place&, const Place&) = default;
};

// Items that are numbered, or (with places) a record that every read brings whole: each value of
// the answer in 16-bit items of its own, a number right-aligned, a text from the left.
struct DeclaredArea {
  std::string name;
  std::string prefix;        // before the number: "holding:", "D"
  std::uint8_t base = 10;    // of the number: 8, 10, 16
  std::uint32_t origin = 0;  // the number of item 0
  std::uint8_t item_bits = 16;
  std::uint32_t items = 65536;
  std::vector<Place> places;
  bool record = false;
  friend bool operator==(const DeclaredArea&, const DeclaredArea&) = default;
};

struct Operation {
  std::string name;
  bool write = false;
  AreaIndex area = 0;
  std::uint64_t command = 0;
  std::uint16_t min_count = 1, max_count = 1;  // items; of a write to a record: those of its values
  std::uint16_t first = 0;                     // of a write to a record: where they begin
  Frame request, answer;
  // The answer of a write equals its request.
  [[nodiscard]] bool echoes() const { return write && request == answer; }
  friend bool operator==(const Operation&, const Operation&) = default;
};

struct Declaration {
  std::string name, summary;
  std::uint16_t lowest_address = 1, highest_address = 247;
  std::vector<DeclaredArea> areas;
  std::vector<Operation> operations;  // the first that fits a request carries it
  Frame refusal;                      // no fields: there is none
  std::map<std::uint16_t, std::string> codes;
  std::vector<std::uint16_t> busy;  // codes that ask to come later
  friend bool operator==(const Declaration&, const Declaration&) = default;
};

// A declaration as a device's specification holds it. Two are equal when their contents are, so
// that a reload restarts only what differs.
struct SharedDeclaration {
  std::shared_ptr<const Declaration> value;
  explicit operator bool() const { return value != nullptr; }
  friend bool operator==(const SharedDeclaration& a, const SharedDeclaration& b) {
    return a.value == b.value || (a.value && b.value && *a.value == *b.value);
  }
};

// A protocol for one device. REQUIRES: `declaration` has passed the loader.
[[nodiscard]] tl::expected<std::unique_ptr<Protocol>, OptionFault> make(
    std::shared_ptr<const Declaration> declaration, const DeviceLink& link);

// One frame for people, read as that of the declaration's frames which it fits best.
[[nodiscard]] std::vector<FrameField> explain(const Declaration& declaration, ByteView frame);

// As RequestMatcher, of this declaration.
[[nodiscard]] SeenRequest seen_request(const Declaration& declaration, ByteView bytes);

}  // namespace fieldcast::declared

// A device family described by data: its areas, and the fields of the frames of each operation
// (Declaration > Operation > Frame > Field). The loader (config/declaration) has checked every
// REQUIRES here; DeclaredProtocol executes it. Immutable values, any thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/protocol/declared/escape.hpp"
#include "core/protocol/declared/word.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::declared {

inline constexpr std::size_t kMaxFields = 250;     // of a frame
inline constexpr std::size_t kMaxOperations = 64;  // of a declaration
// Characters of a frame, regardless of its length field.
inline constexpr std::size_t kMaxFrame = 4096;
// Of the place of a scaled value: a sign, 20 digits and "e-128".
inline constexpr std::uint16_t kScaledCharacters = 26;

// Decimal numbers whose last two digits are 00 to 15; see Notation::kChannel.
inline constexpr std::uint8_t kChannelBase = 100;

enum class FieldKind : std::uint8_t {
  kConstant,  // always `number`, or the characters of `text`
  kAddress,   // device address; make() sets `text` if it is written as characters
  kCommand,   // command of the operation, plus `plus`
  kFirst,     // first item of the range * times + plus
  kCount,     // items of the range * times + plus
  kLast,      // last item of the range * times + plus
  kLength,    // size of the fields `of`, in `counts`, plus `plus`
  kItems,     // items of the range
  kValue,     // a named place of a record
  kChecksum,  // over the fields `of`
  kError,     // device code: must be `number` in a response and differ from it in a refusal
  kSequence,  // counts exchanges; the response repeats it
  kExponent,  // power of ten of the values `of`, plus `plus`
  kDecimals,  // number of decimals of the values `of`, plus `plus`
  kSign,      // `on` if the values or the exponent `of` are negative, else sent as `off`
  kRate,      // code of the baud rate of the response, which the device has named in `rates`
  kUnused,    // sent as `number`; ignored on reception
};

// As a declaration writes them, `is: address`; a constant has no word.
inline constexpr std::pair<std::string_view, FieldKind> kFieldKinds[] = {
    {"address", FieldKind::kAddress},   {"command", FieldKind::kCommand},
    {"first", FieldKind::kFirst},       {"count", FieldKind::kCount},
    {"last", FieldKind::kLast},         {"length", FieldKind::kLength},
    {"items", FieldKind::kItems},       {"value", FieldKind::kValue},
    {"checksum", FieldKind::kChecksum}, {"error", FieldKind::kError},
    {"sequence", FieldKind::kSequence}, {"unused", FieldKind::kUnused},
    {"exponent", FieldKind::kExponent}, {"decimals", FieldKind::kDecimals},
    {"sign", FieldKind::kSign},         {"rate", FieldKind::kRate}};
[[nodiscard]] constexpr std::string_view to_text(FieldKind kind) {
  for (const auto& [word, each] : kFieldKinds) {
    if (each == kind) return word;
  }
  return "constant";
}

// Both ends are inclusive.
struct Span {
  std::uint8_t from = 0, to = 0;
  [[nodiscard]] bool holds(std::size_t field) const { return field >= from && field <= to; }
  friend bool operator==(const Span&, const Span&) = default;
};

enum class Counts : std::uint8_t { kBytes, kCharacters, kItems };

// Fields narrower than their word share it; the first carries its characters.
struct Field {
  std::string name;
  FieldKind kind = FieldKind::kConstant;
  Word word;  // notation of the number; for items, of one item or of one byte of packed bits
  std::uint8_t bits = 8;           // 1..64, of this field's number
  std::uint8_t shift = 0;          // position of its lowest bit in the word
  bool opens = true;               // first field of its word
  bool is_signed = false;          // a value narrower than its items is sign-extended
  Counts counts = Counts::kBytes;  // unit of a length
  ByteTransform transform;         // of each byte of the field
  // The text may be shorter: it ends at the next constant, or as a length field says.
  bool variable = false;
  std::uint16_t text_size = 0;  // maximum characters of a text value, or of an address as text
  TextNumber text_number = {};  // format of a number written as text; empty for plain text
  std::string text;             // of a text constant
  // Of a value in a block: the characters before it, the DIF and VIF of an M-Bus record, or a tag.
  // Fields with a key that follow each other are one block, in which their values have any order.
  std::string key;
  std::string after;  // characters between the key of a text and its value, with others before them
  std::string until;  // characters behind a text with a key
  std::uint64_t number = 0;
  std::uint32_t times = 1;
  std::int64_t plus = 0;
  Span of;
  Check check;
  std::uint64_t on = 1, off = 0;  // values of a bit that has its own word
  bool packed = false;            // eight bit items per byte, the first lowest
  std::string separator;          // characters between two items
  std::uint16_t place = 0;        // of a value: its first item in the record
  // Of a rate in the response before the request: baud by code; `number` is the usual code.
  std::map<std::uint64_t, std::uint32_t> rates;
  // Of a value: the fields that scale and sign it. An exponent may have a sign, too.
  std::optional<std::uint8_t> exponent, sign;
  [[nodiscard]] constexpr bool scaled() const {
    return kind == FieldKind::kValue && (exponent || sign);
  }
  friend bool operator==(const Field&, const Field&) = default;
};

// Whether the field scales or signs others.
[[nodiscard]] constexpr bool scales(const Field& field) {
  return field.kind == FieldKind::kExponent || field.kind == FieldKind::kDecimals ||
         field.kind == FieldKind::kSign;
}

// The character of an unused text in sent frames.
[[nodiscard]] constexpr std::uint8_t blank_of(const Field& unused) {
  return unused.number == 0 ? ' ' : static_cast<std::uint8_t>(unused.number);
}

// The form of the values in a block.
enum class Block : std::uint8_t {
  kRecords,         // lines of text (IEC 62056-21), or M-Bus data records
  kTagValue,        // the tag determines the length
  kTagLengthValue,  // a byte behind the tag counts the bytes of the value
};

struct Frame {
  std::vector<Field> fields;
  Block block = Block::kRecords;
  Escape escape = Escape::kNone;  // of the fields `escaped`, between the marks of the frame
  Span escaped;
  friend bool operator==(const Frame&, const Frame&) = default;
};

// A named place of a record: `items` 16-bit items from `first`, a number of `bits` or a text.
struct Place {
  std::string name;
  std::uint16_t first = 0, items = 1;
  std::uint8_t bits = 16;        // 0 for a text
  bool is_signed = false;        // a number narrower than its items is sign-extended
  std::uint16_t characters = 0;  // of a text
  TextNumber text_number = {};
  bool scaled = false;  // the text of a scaled value
  friend bool operator==(const Place&, const Place&) = default;
};

// Numbered items, or (with places) a record that each read returns as a whole. Each value has its
// own 16-bit items: a number is right-aligned, a text left-aligned.
struct DeclaredArea {
  std::string name;
  std::string prefix;        // before the number: "holding:", "D"
  std::uint8_t base = 10;    // of the number: 8, 10, 16 or kChannelBase
  std::uint32_t origin = 0;  // number of item 0
  std::uint8_t item_bits = 16;
  std::uint32_t items = 65536;
  std::vector<Place> places;
  bool record = false;
  bool trigger = false;  // a command without a value: its only item is a bit that is written as 1
  friend bool operator==(const DeclaredArea&, const DeclaredArea&) = default;
};

struct Operation {
  std::string name;
  bool write = false;
  AreaIndex area = 0;
  std::uint64_t command = 0;
  // Items; for a write to a record, the items of its values.
  std::uint16_t min_count = 1, max_count = 1;
  std::uint16_t first = 0;  // for a write to a record: its first item
  Frame request, response;
  // Other forms of the response that reads a record; each has some of its places.
  std::vector<Frame> others;
  std::vector<Operation> before;  // rounds before the request, without areas
  // Usual time between two frames that the device sends by itself; zero: it waits for `request`.
  Duration unsolicited{};
  // Pause behind a write that has no `response`; zero: it has one.
  Duration no_response{};
  // Whether the response of a write can have the bytes of its request.
  [[nodiscard]] bool echoes() const;
  // Baud of the response if its request repeats this code; empty: the usual one. 0: that of the
  // line, or no such code.
  [[nodiscard]] std::uint32_t response_baud(std::optional<std::uint64_t> code = {}) const;
  // The form `n` of the response; they repeat.
  [[nodiscard]] const Frame& form(std::size_t n) const {
    const std::size_t index = n % (others.size() + 1);
    return index == 0 ? response : others[index - 1];
  }
  friend bool operator==(const Operation&, const Operation&) = default;
};

// Characters of the longest form of the response.
[[nodiscard]] std::size_t response_size(const Operation& operation, unsigned item_bits,
                                        std::uint32_t count);
[[nodiscard]] bool in_each_form(const Operation& operation, FieldKind kind);

struct Declaration {
  std::string name, summary;
  std::uint16_t lowest_address = 1;
  std::uint64_t highest_address = 247;
  std::uint16_t address_characters = 0;  // of addresses that are text; 0 if they are numbers
  std::vector<DeclaredArea> areas;
  std::vector<Operation> operations;  // a request uses the first operation that fits
  std::vector<Operation> login;       // rounds before the first exchange of a connection
  std::vector<Frame> refusals;        // empty: the device refuses nothing, or stays silent
  std::map<std::uint16_t, std::string> codes;
  std::vector<std::uint16_t> busy;  // codes that mean busy
  // Whether a response comes at another baud rate than its request.
  [[nodiscard]] bool changes_rate() const;
  friend bool operator==(const Declaration&, const Declaration&) = default;
};

// Compared by content, so that a reload only restarts what changed.
struct SharedDeclaration {
  std::shared_ptr<const Declaration> value;
  explicit operator bool() const { return value != nullptr; }
  friend bool operator==(const SharedDeclaration& a, const SharedDeclaration& b) {
    return a.value == b.value || (a.value && b.value && *a.value == *b.value);
  }
};

struct DeviceAddress {
  std::uint64_t number = 0;
  std::string text;  // if the addresses of the declaration are text
};
[[nodiscard]] tl::expected<DeviceAddress, OptionFault> device_address(
    const Declaration& declaration, const DeviceLink& link);

// REQUIRES: the loader accepted `declaration`.
[[nodiscard]] tl::expected<std::unique_ptr<Protocol>, OptionFault> make(
    std::shared_ptr<const Declaration> declaration, const DeviceLink& link);

enum class Sender : std::uint8_t { kUnknown, kBridge, kDevice };
// Reads the frame as the one of the declaration that it matches best; `sender` decides if several
// match equally. Offsets are those of the wire.
[[nodiscard]] std::vector<FrameField> explain(const Declaration& declaration, ByteView frame,
                                              Sender sender = Sender::kUnknown);

// Whether `bytes` begin with a response or a refusal that has a valid checksum, of any device.
[[nodiscard]] bool begins_checked_response(const Declaration& declaration, ByteView bytes);

// See Protocol::find_unsolicited().
[[nodiscard]] UnsolicitedFrame find_unsolicited(const Declaration& declaration,
                                                std::uint64_t address, ByteView bytes,
                                                bool boundary);

[[nodiscard]] SeenRequest seen_request(const Declaration& declaration, ByteView bytes);

// The number of an item by its digits, in the base of the area. Empty if it is not such a number.
[[nodiscard]] std::optional<std::uint32_t> area_number(const DeclaredArea& area,
                                                       std::string_view digits);

// `holding:100`. REQUIRES: item < area.items.
[[nodiscard]] std::string item_text(const DeclaredArea& area, std::uint32_t item);

// `holding:100`, `holding:100.5`, or a place of a record by its name. Pure.
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(
    const Declaration& declaration, std::string_view at);

}  // namespace fieldcast::declared

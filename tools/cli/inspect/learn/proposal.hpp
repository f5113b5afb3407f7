// Proposes the fields of an unknown protocol from its exchanges, as the text of a declaration
// (config/protocols/README.md). Pure values and functions.
//
//   exchanges -> groups (one for each operation) -> roles of columns -> fields of each frame
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "tools/cli/inspect/learn/exchange_pairing.hpp"
#include "tools/cli/inspect/learn/length_rule.hpp"

namespace fieldcast::learn {

// Limits keep the time bounded: the first kMaxGroups operations, and columns at the start.
inline constexpr std::size_t kMaxGroups = 24;
inline constexpr std::ptrdiff_t kMaxHead = 24;

struct LearnedField {
  declared::FieldKind kind = declared::FieldKind::kUnused;
  std::ptrdiff_t at = 0;  // below 0: from the end of the frame
  std::size_t width = 0;  // characters; 0: as many as the others leave
  declared::Word word;    // of a number
  Evidence evidence;
  std::string note;     // why it is unsure; empty if it is sure
  std::string options;  // further keys of the declaration: ", kind: sum"
  Bytes constant;
  std::int64_t plus = 0;
  std::uint8_t add = 0;      // added to each byte on the wire
  bool variable = false;     // a text that ends at the constant behind it
  bool pairs = false;        // a length or checksum of bytes, each in two hexadecimal digits
  std::ptrdiff_t from = -1;  // first character that a length or a checksum covers
  // The response has it so many characters later; empty: it has not.
  std::optional<std::ptrdiff_t> echo;
  std::string name, of;  // unique in its frame; the covered fields
  [[nodiscard]] std::ptrdiff_t end() const { return at + static_cast<std::ptrdiff_t>(width); }
  [[nodiscard]] bool holds(std::ptrdiff_t column) const { return column >= at && column < end(); }
};

struct LearnedOperation {
  std::string name;
  std::vector<LearnedField> request, response;  // no request: the device sends by itself
  std::optional<std::uint64_t> command;
  unsigned item_bits = 0;  // 0: a record
  std::uint64_t lowest_count = 1, highest_count = 1;
  std::uint64_t origin = 0, items = 0;  // of the area
  std::size_t exchanges = 0;
  std::optional<LengthRule> rule;  // of the length of its responses
  std::string refusal;             // why it is not in the declaration; empty if it is
};

struct Proposal {
  bool text = false;
  std::string_view escape;  // of the frames; empty: none
  std::vector<LearnedOperation> operations;
  std::uint64_t lowest_address = 1, highest_address = 1;  // 1 to 1: frames have no address
  std::vector<std::string> notes;
  [[nodiscard]] bool is_declarable() const {
    return std::ranges::any_of(operations, [](const auto& each) { return each.refusal.empty(); });
  }
};

[[nodiscard]] Proposal learn(const std::vector<Exchange>& exchanges);

// "is: count, bytes: 2": the field, without its name.
[[nodiscard]] std::string content_of(const LearnedField& field, bool text);
// Each field has its position, its frames and its note in a comment. Operations that cannot be
// declared are comments; only comments if none can.
[[nodiscard]] std::string declaration_text(const Proposal& proposal);

// Frames in which the declaration finds no fault.
[[nodiscard]] Evidence explained_by(const declared::Declaration& declaration,
                                    const std::vector<Exchange>& exchanges);

}  // namespace fieldcast::learn

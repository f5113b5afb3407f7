// Proposes the fields of an unknown protocol from its exchanges. Pure values and functions.
//
//   exchanges -> groups (one for each operation) -> roles of columns -> fields of each frame
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/protocol/declared/declaration.hpp"
#include "tools/cli/inspect/learn/checksum_search.hpp"
#include "tools/cli/inspect/learn/exchange_pairing.hpp"
#include "tools/cli/inspect/learn/length_rule.hpp"

namespace fieldcast::learn {

struct LearnedField {
  declared::FieldKind kind = declared::FieldKind::kUnused;
  std::ptrdiff_t at = 0;  // below 0: from the end of the frame
  std::size_t width = 0;  // characters; 0: as many as the others leave
  declared::Word word;    // of a number
  std::string name;       // unique in its frame
  Bytes constant;
  std::string check_kind;  // of a checksum
  declared::Check check;
  std::string of_first, of_last;  // fields that a length or a checksum covers
  std::int64_t plus = 0;
  bool characters = false;  // a length of digits counts characters
  bool bits = false;        // items: eight in a byte
  std::uint8_t add = 0;     // added to each byte on the wire
  unsigned text = 0;        // of a value: most characters; 0: a number
  bool decimal = false;     // the text is a number
  bool variable = false;
  Evidence evidence;
  std::string note;  // empty if it is sure
};

struct LearnedOperation {
  std::string name;
  std::vector<LearnedField> request, response;  // no request: the device sends by itself
  std::optional<std::uint64_t> command;
  unsigned item_bits = 0;  // 0: a record
  std::uint64_t lowest_count = 1, highest_count = 1;
  std::uint64_t lowest_first = 0, highest_first = 0;
  std::size_t exchanges = 0;
  std::optional<LengthRule> rule;  // of the length of its responses
  std::string refusal;             // why it is not in the declaration; empty if it is
};

struct Proposal {
  bool text = false;
  std::vector<LearnedOperation> operations;
  std::uint64_t lowest_address = 1, highest_address = 1;  // 1 to 1: frames have no address
  std::vector<std::string> notes;
  [[nodiscard]] bool is_declarable() const {
    return std::ranges::any_of(operations, [](const auto& each) { return each.refusal.empty(); });
  }
};

// Limits keep the time bounded: the first kMaxGroups operations, and columns at the start.
inline constexpr std::size_t kMaxGroups = 24;
inline constexpr std::ptrdiff_t kMaxHead = 24;

[[nodiscard]] Proposal learn(const std::vector<Exchange>& exchanges);

// Frames in which the declaration finds no fault.
[[nodiscard]] Evidence explained_by(const declared::Declaration& declaration,
                                    const std::vector<Exchange>& exchanges);

}  // namespace fieldcast::learn

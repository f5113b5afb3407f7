// A frame of a declared protocol while it is read: its fields, each with its position in the text.
// Inside config/ only.
#pragma once

#include <string>
#include <vector>

#include "config/map_reader.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::config {

// Defaults of the fields of a frame.
struct FieldDefaults {
  declared::Notation notation = declared::Notation::kBinary;
  bool little_endian = false;
  // Of fields that share a byte the first takes the highest bits, not the lowest.
  bool high_first = false;
};

// One field as it stands in the text.
struct DraftField {
  declared::Field field;
  Position position;
  Position width_position, of_position;
  std::string of;
  bool in_bits = false;  // its width is given in bits
  bool shares = false;   // its bits fill no whole bytes: it shares one with others
  bool fits = true;      // read without a fault
};

struct DraftFrame {
  std::vector<DraftField> fields;
  Position position;
  bool good = true;
  [[nodiscard]] declared::Frame frame() const;
  [[nodiscard]] const DraftField* find(declared::FieldKind kind) const;
};

struct DraftOperation {
  declared::Operation operation;
  Position position, count_position;
  DraftFrame request, answer;
  bool has_command = false;
  bool good = true;  // its area is known
};

// `item_bits`: of the area whose items the frame may hold.
[[nodiscard]] DraftField read_field(const Node& node, const FieldDefaults& defaults,
                                    unsigned item_bits, FaultList& faults);

// A list of fields; spans are resolved, shared bytes put together.
[[nodiscard]] DraftFrame read_frame(const Node& node, std::string_view what,
                                    const FieldDefaults& defaults, unsigned item_bits,
                                    FaultList& faults);

// Gives every value its offset in the record, by the reads' answers.
void place_values(declared::Declaration& declaration, std::vector<DraftOperation>& operations,
                  FaultList& faults);

// What contradicts itself: fields too narrow for what they must hold, answers whose length nothing
// tells, and the like.
void check_operation(const declared::Declaration& declaration, const DraftOperation& operation,
                     FaultList& faults);
void check_refusal(const declared::Declaration& declaration,
                   const std::vector<DraftOperation>& operations, const DraftFrame& refusal,
                   FaultList& faults);

}  // namespace fieldcast::config

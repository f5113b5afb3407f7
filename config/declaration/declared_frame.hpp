// All keys of a declared protocol; a test compares them with config/protocol.schema.json.
#pragma once

#include <string>
#include <vector>

#include "config/document/map_reader.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::config {

extern const KeyTable kDeclarationKeys, kAddressesKeys, kAreaKeys, kOperationKeys, kCountKeys,
    kErrorsKeys, kFieldKeys, kCrcKeys, kRoundKeys, kGroupKeys;

[[nodiscard]] std::span<const KeyTable* const> declaration_key_tables();

// A frame of a declared protocol during parsing. Only used in config/.
struct FieldDefaults {
  declared::Notation notation = declared::Notation::kBinary;
  bool little_endian = false;
  // The first field of a shared byte uses the highest bits instead of the lowest.
  bool high_first = false;
  declared::Escape escape = declared::Escape::kNone;
  declared::Block block = declared::Block::kRecords;
  std::uint32_t origin = 0;  // of the area: `plus: origin`
};

struct DraftField {
  declared::Field field;
  Position position;
  Position width_position, of_position;
  std::string of;
  bool in_bits = false;  // its width is given in bits
  bool shares = false;   // its bits are not whole bytes: it shares one with other fields
  bool fits = true;      // read without a fault
  bool placed = false;   // of a value: its place is that of an earlier form of the response
};

struct DraftFrame {
  std::vector<DraftField> fields;
  declared::Block block = declared::Block::kRecords;
  declared::Escape escape = declared::Escape::kNone;
  declared::Span escaped;
  Position position;
  bool good = true;
  [[nodiscard]] declared::Frame frame() const;
  [[nodiscard]] const DraftField* find(declared::FieldKind kind) const;
};

struct DraftOperation {
  declared::Operation operation;
  Position position, count_position;
  DraftFrame request, response;
  std::vector<DraftFrame> others;  // forms of the response
  bool has_command = false;
  bool good = true;  // its area is known
};

// `item_bits`: of the area of the frame's items.
[[nodiscard]] DraftField read_field(const Node& node, const FieldDefaults& defaults,
                                    unsigned item_bits, FaultList& faults);

// Adds a fault for each key that has no meaning for a field of this kind.
void refuse_meaningless(MapReader& field, declared::FieldKind kind);

// The name of a checksum, or the parameters of a CRC; `check_words`: what is allowed.
[[nodiscard]] std::optional<declared::Check> read_check(const Node& node, FaultList& faults);
[[nodiscard]] std::string check_words();

// Resolves spans and combines shared bytes.
[[nodiscard]] DraftFrame read_frame(const Node& node, std::string_view what,
                                    const FieldDefaults& defaults, unsigned item_bits,
                                    FaultList& faults);

// Sets the offset of every value in its record, from the responses of the reads.
void place_values(declared::Declaration& declaration, std::vector<DraftOperation>& operations,
                  FaultList& faults);

void check_operation(const declared::Declaration& declaration, const DraftOperation& operation,
                     FaultList& faults);
// Requests without a value or an item must differ, also from the rounds of the login.
void check_requests(const std::vector<DraftOperation>& operations,
                    const std::vector<declared::Operation>& login, FaultList& faults);
// The forms of a response must differ.
void check_forms(const DraftOperation& draft, const declared::DeclaredArea& area,
                 FaultList& faults);
// `round`: a round before a request, with its frames.
void check_round(const declared::Declaration& declaration, const DraftOperation& round,
                 FaultList& faults);
void check_refusal(const declared::Declaration& declaration,
                   const std::vector<DraftOperation>& operations, const DraftFrame& refusal,
                   FaultList& faults);

}  // namespace fieldcast::config

#include "tools/cli/inspect/learn/proposal_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/message_text.hpp"
#include "tools/cli/inspect/learn/field_layout.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;
using declared::Notation;

constexpr std::string_view kResponseKey = "answer";
constexpr std::uint64_t kMaxItems = 1 << 24;  // of an area

// "STX", or [0x02, 0x41].
std::string constant_text(const Bytes& bytes, bool text_protocol) {
  const auto plain = [](std::uint8_t c) { return c <= '~' && c != '"' && c != '\\' && c != 0; };
  const bool readable =
      std::ranges::any_of(bytes, [](auto c) { return c > ' '; }) || bytes.size() > 1;
  if (text_protocol && readable && std::ranges::all_of(bytes, plain)) {
    std::string text;
    for (const std::uint8_t c : bytes)
      text += c == '\r'   ? "\\r"
              : c == '\n' ? "\\n"
              : c < ' '   ? fmt::format("\\x{:02X}", c)
                          : std::string(1, static_cast<char>(c));
    return '"' + text + '"';
  }
  if (bytes.size() == 1) return fmt::format("0x{:02X}", bytes.front());
  std::string list;
  for (const std::uint8_t c : bytes) list += fmt::format("{}0x{:02X}", list.empty() ? "" : ", ", c);
  return '[' + list + ']';
}

std::string number_text(const declared::Word& word) {
  if (word.notation == Notation::kHex)
    return fmt::format(", as: hex, digits: {}{}", word.characters,
                       word.little_endian ? ", order: little-endian" : "");
  if (word.notation == Notation::kDecimal)
    return fmt::format(", as: decimal, digits: {}", word.characters);
  return fmt::format("{}{}{}", word.notation == Notation::kBcd ? ", as: bcd" : "",
                     word.characters > 1 ? fmt::format(", bytes: {}", word.characters) : "",
                     word.little_endian ? ", order: little-endian" : "");
}

std::string span_text(const LearnedField& field) {
  return field.of_first == field.of_last ? field.of_first : field.of_first + ".." + field.of_last;
}

std::string checksum_text(const LearnedField& field) {
  std::string text = fmt::format(", kind: {}", field.check_kind);
  const bool ones = field.check.complement == declared::Complement::kOnes;
  if (ones) text += ", complement: ones";
  text += fmt::format(", of: {}", span_text(field));
  if (field.check.over_bytes) text += ", over: bytes";
  return text + number_text(field.word);
}

// Items beyond the first 65536 belong to an area that begins near them.
std::uint64_t origin_of(const LearnedOperation& operation) {
  return operation.highest_first > UINT16_MAX ? operation.lowest_first & ~std::uint64_t{0xFFFF} : 0;
}

std::string add_text(const LearnedField& field) {
  return field.add != 0 ? fmt::format(", add: 0x{:02X}", field.add) : "";
}

std::string items_text(const LearnedField& field, unsigned item_bits) {
  if (field.bits) return field.word.notation == Notation::kHex ? ", as: hex" : "";
  if (item_bits == 1) return ", as: hex, digits: 1, on: 1, off: 0";
  if (field.word.notation == Notation::kHex) return ", as: hex";
  if (field.word.notation == Notation::kBcd) return number_text(field.word) + add_text(field);
  return field.word.notation == Notation::kDecimal ? number_text(field.word) : "";
}

std::string content_of(const LearnedField& field, const LearnedOperation& operation, bool text) {
  const std::string kind = "is: " + word_of(field.kind);
  switch (field.kind) {
    case FieldKind::kConstant: return "constant: " + constant_text(field.constant, text);
    case FieldKind::kChecksum: return kind + checksum_text(field);
    case FieldKind::kItems: return kind + items_text(field, operation.item_bits);
    case FieldKind::kLength:
      return kind + ", of: " + span_text(field) + number_text(field.word) +
             (field.word.notation != Notation::kBinary && field.characters ? ", counts: characters"
                                                                           : "") +
             (field.plus != 0 ? fmt::format(", plus: {}", field.plus) : "");
    case FieldKind::kValue:
      if (field.text != 0)
        return kind + ", text: " +
               (field.decimal ? fmt::format("decimal({})", field.text)
                              : std::to_string(field.text)) +
               (field.variable ? ", variable: true" : "");
      return kind + number_text(field.word);
    case FieldKind::kFirst:
    case FieldKind::kLast:
      return kind + number_text(field.word) + (origin_of(operation) != 0 ? ", plus: origin" : "") +
             add_text(field);
    default:
      return kind + number_text(field.word) +
             (field.plus != 0 ? fmt::format(", plus: 0x{:02X}", field.plus) : "");
  }
}

std::string fields_text(const std::vector<LearnedField>& fields, const LearnedOperation& operation,
                        bool text) {
  std::string lines;
  for (const LearnedField& field : fields) {
    const bool named = field.name != word_of(field.kind);
    std::string line =
        fmt::format("      - {{ {}{} }}", named ? fmt::format("name: {}, ", field.name) : "",
                    content_of(field, operation, text));
    if (!field.note.empty()) line += "  # " + field.note;
    lines += line + '\n';
  }
  return lines;
}

std::string count_of(const LearnedOperation& operation) {
  return counted(operation.exchanges, "exchange", "exchanges");
}

enum class AreaKind : std::uint8_t { kItems, kRecord, kTrigger };
AreaKind kind_of(const LearnedOperation& operation) {
  if (operation.item_bits != 0) return AreaKind::kItems;
  return std::ranges::find(operation.response, FieldKind::kValue, &LearnedField::kind) ==
                 operation.response.end()
             ? AreaKind::kTrigger
             : AreaKind::kRecord;
}

// The items that the request can name.
std::uint64_t items_of(const LearnedOperation& operation) {
  const std::uint64_t origin = origin_of(operation);
  std::uint64_t items =
      origin == 0 ? 65536 : std::min(operation.highest_first - origin + 65536, kMaxItems);
  for (const LearnedField& field : operation.request) {
    if (field.kind == FieldKind::kFirst)
      items = std::min(items - 1, declared::largest(field.word) - origin) + 1;
  }
  return items;
}

std::string area_text(const LearnedOperation& operation, std::size_t number) {
  switch (kind_of(operation)) {
    case AreaKind::kRecord: return fmt::format("  - {{ name: area-{}, record: true }}\n", number);
    case AreaKind::kTrigger: return fmt::format("  - {{ name: area-{}, trigger: true }}\n", number);
    case AreaKind::kItems: break;
  }
  const std::string item = operation.item_bits == 1   ? "bit"
                           : operation.item_bits == 8 ? "byte"
                                                      : fmt::format("{}bit", operation.item_bits);
  const bool first = std::ranges::find(operation.request, FieldKind::kFirst, &LearnedField::kind) !=
                     operation.request.end();
  const std::uint64_t origin = origin_of(operation);
  return fmt::format("  - {{ name: area-{}, item: {}, items: {}{} }}\n", number, item,
                     first ? items_of(operation) : operation.highest_count,
                     origin != 0 ? fmt::format(", base: hexadecimal, origin: 0x{:X}", origin) : "");
}

std::string operation_text(const LearnedOperation& operation, std::size_t number, bool is_text) {
  const bool trigger = kind_of(operation) == AreaKind::kTrigger;
  std::string text = fmt::format(
      "  - name: {}  # {}{}\n    {}: area-{}\n", operation.name, count_of(operation),
      trigger ? "; no value in the response: a command" : "", trigger ? "write" : "read", number);
  if (operation.command) text += fmt::format("    command: 0x{:02X}\n", *operation.command);
  if (operation.item_bits != 0 && operation.highest_count > 1) {
    text += operation.lowest_count == operation.highest_count
                ? fmt::format("    count: {{ from: {0}, to: {0} }}", operation.highest_count)
                : fmt::format("    count: {}", operation.highest_count);
    text += "  # the most of the capture\n";
  }
  if (operation.request.empty())
    text += "    unsolicited: 1s  # the usual time between two frames\n";
  else
    text += "    request:\n" + fields_text(operation.request, operation, is_text);
  return text + fmt::format("    {}:\n", kResponseKey) +
         fields_text(operation.response, operation, is_text);
}

}  // namespace

std::vector<FieldRow> rows_of(const LearnedOperation& operation, bool text) {
  std::vector<FieldRow> rows;
  const auto add = [&](const std::string& frame, const std::vector<LearnedField>& fields) {
    for (const LearnedField& field : fields)
      rows.push_back({frame, field.at, field.width, content_of(field, operation, text),
                      field.evidence.holds, field.evidence.of, field.note});
  };
  add("request", operation.request);
  add("response", operation.response);
  return rows;
}

std::string declaration_text(const Proposal& proposal) {
  std::string text = "summary: Proposed from a capture; check each field against a manual\n";
  text += fmt::format("addresses: {{ from: {}, to: {} }}\n", proposal.lowest_address,
                      proposal.highest_address);
  std::string areas, operations;
  for (std::size_t i = 0; i < proposal.operations.size(); ++i) {
    const LearnedOperation& operation = proposal.operations[i];
    if (!operation.refusal.empty()) {
      operations +=
          fmt::format("  # {}, {}: {}\n", operation.name, count_of(operation), operation.refusal);
      continue;
    }
    areas += area_text(operation, i + 1);
    operations += operation_text(operation, i + 1, proposal.text);
  }
  if (areas.empty()) return operations;
  for (const std::string& note : proposal.notes) text = fmt::format("# {}\n", note) + text;
  return text + "areas:\n" + areas + "operations:\n" + operations;
}

}  // namespace fieldcast::learn

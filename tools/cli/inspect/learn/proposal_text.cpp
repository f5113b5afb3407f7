#include <fmt/format.h>

#include "core/base/message_text.hpp"
#include "tools/cli/inspect/learn/frame_fields.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;
using declared::Notation;

constexpr std::string_view kResponseKey = "answer";

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
  return fmt::format("[0x{:02X}]", fmt::join(bytes, ", 0x"));
}

std::string number_text(const declared::Word& word) {
  const bool binary = word.notation == Notation::kBinary, bcd = word.notation == Notation::kBcd;
  std::string text;
  if (!binary)
    text += bcd ? ", as: bcd" : word.notation == Notation::kHex ? ", as: hex" : ", as: decimal";
  if (!binary && !bcd) text += fmt::format(", digits: {}", word.characters);
  if ((binary || bcd) && word.characters > 1) text += fmt::format(", bytes: {}", word.characters);
  return text + (word.little_endian ? ", order: little-endian" : "");
}

std::string fields_text(const std::vector<LearnedField>& fields, bool text) {
  std::string lines;
  for (const LearnedField& field : fields) {
    const bool named = field.name != to_text(field.kind);
    const std::string content =
        (named ? "name: " + field.name + ", " : "") + content_of(field, text);
    lines += fmt::format("      {:<52}  # at {}, {}/{}{}\n", "- { " + content + " }", field.at,
                         field.evidence.holds, field.evidence.of,
                         field.note.empty() ? "" : "; " + field.note);
  }
  return lines;
}

std::string count_of(const LearnedOperation& operation) {
  return counted(operation.exchanges, "exchange", "exchanges");
}

bool has(const std::vector<LearnedField>& fields, FieldKind kind) {
  return std::ranges::find(fields, kind, &LearnedField::kind) != fields.end();
}
// A command has no value in its response.
bool is_trigger(const LearnedOperation& operation) {
  return operation.item_bits == 0 && !has(operation.response, FieldKind::kValue);
}

std::string area_text(const LearnedOperation& operation, std::size_t number) {
  if (operation.item_bits == 0)
    return fmt::format("  - {{ name: area-{}, {}: true }}\n", number,
                       is_trigger(operation) ? "trigger" : "record");
  const std::string item = operation.item_bits == 1   ? "bit"
                           : operation.item_bits == 8 ? "byte"
                                                      : fmt::format("{}bit", operation.item_bits);
  return fmt::format(
      "  - {{ name: area-{}, item: {}, items: {}{} }}\n", number, item, operation.items,
      operation.origin != 0 ? fmt::format(", base: hexadecimal, origin: 0x{:X}", operation.origin)
                            : "");
}

std::string operation_text(const LearnedOperation& operation, std::size_t number, bool is_text) {
  const bool trigger = is_trigger(operation);
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
    text += "    request:\n" + fields_text(operation.request, is_text);
  return text + fmt::format("    {}:\n", kResponseKey) + fields_text(operation.response, is_text);
}

}  // namespace

std::string content_of(const LearnedField& field, bool text) {
  const bool digits = field.kind == FieldKind::kConstant && field.word.notation == Notation::kHex;
  if (digits)
    return fmt::format("constant: 0x{}{}",
                       std::string(field.constant.begin(), field.constant.end()),
                       number_text(field.word));
  if (field.kind == FieldKind::kConstant) return "constant: " + constant_text(field.constant, text);
  std::string content = fmt::format("is: {}{}", to_text(field.kind), field.options);
  if (!field.of.empty()) content += ", of: " + field.of;
  // The width of other items is that of the area.
  const bool items = field.kind == FieldKind::kItems && (field.word.notation == Notation::kBinary ||
                                                         field.word.notation == Notation::kHex);
  if (!items && !field.variable && field.options.find(", text:") == std::string::npos)
    content += number_text(field.word);
  if (field.plus != 0) content += fmt::format(", plus: {}", field.plus);
  if (field.add != 0) content += fmt::format(", add: 0x{:02X}", field.add);
  return content;
}

std::string declaration_text(const Proposal& proposal) {
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
  std::string notes;
  for (const std::string& note : proposal.notes) notes += fmt::format("# {}\n", note);
  return fmt::format(
      "{}summary: Proposed from a capture; check each field against a manual\n"
      "addresses: {{ from: {}, to: {} }}\n{}areas:\n{}operations:\n{}",
      notes, proposal.lowest_address, proposal.highest_address,
      proposal.escape.empty() ? "" : fmt::format("escape: {}\n", proposal.escape), areas,
      operations);
}

}  // namespace fieldcast::learn

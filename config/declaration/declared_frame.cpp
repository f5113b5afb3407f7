#include "config/declaration/declared_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/document/scalars.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::config {

namespace {

constexpr std::string_view kDeclaration[] = {"summary",   "addresses", "encoding",   "order",
                                             "bit-order", "areas",     "operations", "errors",
                                             "login",     "escape",    "blocks"};
constexpr std::string_view kAddresses[] = {"from", "to", "text"};
constexpr std::string_view kArea[] = {"name",   "item", "items",  "record",
                                      "prefix", "base", "origin", "trigger"};
constexpr std::string_view kCrc[] = {"width",     "polynomial", "start",
                                     "final-xor", "reflect-in", "reflect-out"};
constexpr std::string_view kOperation[] = {"name",   "read",        "write",       "command",
                                           "before", "unsolicited", "no-response",  // frames:
                                           "count",  "request",     "answer",      "answers"};
constexpr std::string_view kRound[] = {"name", "command", "request",  // and the response:
                                       "answer"};
constexpr std::string_view kCount[] = {"from", "to"};
constexpr std::string_view kErrors[] = {"frame", "frames", "codes", "busy"};
constexpr std::string_view kField[] = {
    "name", "constant", "is",       "bytes", "bits",   "digits",     "as",       "order",
    "plus", "times",    "of",       "kind",  "over",   "on",         "off",      "ok",
    "text", "variable", "signed",   "fill",  "counts", "complement", "add",      "xor",
    "key",  "until",    "optional", "start", "after",  "rates",      "separator"};
constexpr std::string_view kGroup[] = {"repeat", "fields"};

}  // namespace

const KeyTable kDeclarationKeys{"declaration", "a declared protocol", kDeclaration};
const KeyTable kAddressesKeys{"addresses", "'addresses'", kAddresses};
const KeyTable kAreaKeys{"area", "an area", kArea};
const KeyTable kOperationKeys{"operation", "an operation", kOperation};
const KeyTable kRoundKeys{"round", "a round before a request", kRound};
const KeyTable kCountKeys{"count", "'count'", kCount};
const KeyTable kErrorsKeys{"errors", "'errors'", kErrors};
const KeyTable kFieldKeys{"field", "a field", kField};
const KeyTable kCrcKeys{"crc", "the parameters of a CRC", kCrc};
const KeyTable kGroupKeys{"group", "repeated fields", kGroup};

std::span<const KeyTable* const> declaration_key_tables() {
  static constexpr std::array kTables{
      &kDeclarationKeys, &kAddressesKeys, &kAreaKeys, &kOperationKeys, &kCountKeys,
      &kErrorsKeys,      &kFieldKeys,     &kCrcKeys,  &kRoundKeys,     &kGroupKeys};
  return kTables;
}

namespace {

using declared::Field;
using declared::FieldKind;
using declared::Notation;

// Combines fields narrower than a byte into words of whole bytes.
class Sharing {
 public:
  Sharing(DraftFrame& frame, bool high_first, FaultList& faults)
      : frame_(frame), high_first_(high_first), faults_(faults) {}

  void run() {
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) {
      DraftField& draft = frame_.fields[i];
      const bool joins = draft.shares || (bits_ > 0 && draft.in_bits);
      if (!joins) {
        close();
        continue;
      }
      if (bits_ == 0) first_ = i;
      draft.field.opens = bits_ == 0;
      bits_ += draft.field.bits;
      if (bits_ % 8 == 0) share(i + 1);
    }
    close();
  }

 private:
  void close() {
    if (bits_ == 0) return;
    faults_.add(frame_.fields[first_].position,
                fmt::format("the bits from '{}' on fill no whole byte: they are {}",
                            frame_.fields[first_].field.name, bits_),
                "fields of 8, 16, ... bits together", "");
    frame_.good = false;
    bits_ = 0;
  }

  void share(std::size_t end) {
    const Field& opener = frame_.fields[first_].field;
    if (bits_ > 64) {
      faults_.add(frame_.fields[first_].position, "more than 64 bits stand together",
                  "at most 64 bits before they fill whole bytes");
      frame_.good = false;
    } else {
      unsigned below = 0;
      for (std::size_t i = first_; i < end; ++i) {
        Field& field = frame_.fields[i].field;
        if (field.word.notation != opener.word.notation ||
            field.word.little_endian != opener.word.little_endian) {
          faults_.add(frame_.fields[i].position,
                      fmt::format("'{}' shares a byte with '{}', which is written otherwise",
                                  field.name, opener.name),
                      "the same 'as' and 'order'");
          frame_.good = false;
        }
        field.shift = static_cast<std::uint8_t>(high_first_ ? bits_ - below - field.bits : below);
        below += field.bits;
      }
      const auto characters =
          static_cast<std::uint8_t>(opener.word.notation == Notation::kHex ? bits_ / 4 : bits_ / 8);
      for (std::size_t i = first_; i < end; ++i)
        frame_.fields[i].field.word.characters = characters;
    }
    bits_ = 0;
  }

  DraftFrame& frame_;
  const bool high_first_;
  FaultList& faults_;
  std::size_t first_ = 0;
  unsigned bits_ = 0;  // of the current word
};

// Adds a fault if there is none, or several.
std::optional<std::uint8_t> field_named(const DraftFrame& frame, std::string_view name,
                                        const Position& position, FaultList& faults) {
  std::vector<std::string_view> names;
  std::optional<std::uint8_t> found;
  unsigned times = 0;
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    names.push_back(frame.fields[i].field.name);
    if (names.back() == name) found = static_cast<std::uint8_t>(i), ++times;
  }
  if (times == 1) return found;
  if (times == 0)
    faults.add(position, fmt::format("no field is named '{}'", name), joined(names),
               closest(name, names));
  else
    faults.add(position, fmt::format("{} fields are named '{}'", times, name),
               "names that occur once");
  return std::nullopt;
}

void resolve_span(DraftFrame& frame, std::size_t at, FaultList& faults) {
  DraftField& draft = frame.fields[at];
  if (draft.of.empty()) return;
  const std::string_view text = draft.of;
  const auto dots = text.find("..");
  const auto from = field_named(frame, text.substr(0, dots), draft.of_position, faults);
  const auto to = dots == text.npos
                      ? from
                      : field_named(frame, text.substr(dots + 2), draft.of_position, faults);
  frame.good = frame.good && from && to;
  if (!from || !to) return;
  draft.field.of = {*from, *to};
  if (*from > *to) {
    faults.add(draft.of_position, fmt::format("'{}' runs backwards", text), {},
               fmt::format("{}..{}", text.substr(dots + 2), text.substr(0, dots)));
  } else if (draft.field.kind == FieldKind::kChecksum && draft.field.of.holds(at)) {
    faults.add(draft.of_position, "a checksum over itself", "fields before or behind it");
  } else if (declared::scales(draft.field)) {
    return;
  } else if (!frame.fields[*from].field.opens ||
             (*to + 1u < frame.fields.size() && !frame.fields[*to + 1u].field.opens)) {
    faults.add(draft.of_position, fmt::format("'{}' begins or ends within a byte", text),
               "whole bytes");
  } else {
    return;
  }
  frame.good = false;
}

// Digits of variable width, and items between separators, end at the constant behind them.
void check_number_end(DraftFrame& frame, std::size_t at, FaultList& faults) {
  const Field& field = frame.fields[at].field;
  const std::string& separator = field.separator;
  if (!field.word.variable && separator.empty()) return;
  const auto continues = [&](char c) {
    const auto byte = static_cast<std::uint8_t>(c);
    return field.word.variable &&
           declared::could_begin(ByteView(&byte, 1), {.notation = field.word.notation});
  };
  const DraftField* next = at + 1 < frame.fields.size() ? &frame.fields[at + 1] : nullptr;
  const bool constant = next != nullptr && next->field.kind == FieldKind::kConstant &&
                        !next->field.variable && !next->shares;
  const char end = constant ? static_cast<char>(constant_characters(next->field)[0]) : '0';
  if (constant && !continues(end) &&
      (separator.empty() || (!continues(separator[0]) && separator[0] != end)))
    return;
  faults.add(frame.fields[at].position,
             fmt::format("no character shows where '{}' ends", field.name),
             separator.empty() ? "a constant behind it that does not begin with a digit"
                               : "a separator and a constant behind the items that begin with "
                                 "different characters, and not with digits");
  frame.good = false;
}

// Assigns an exponent, decimals or a sign to the values that it names.
void resolve_scaled(DraftFrame& frame, std::size_t at, FaultList& faults) {
  DraftField& draft = frame.fields[at];
  const auto refuse = [&](const std::string& what, std::string_view allowed) {
    faults.add(draft.of_position, what, std::string(allowed));
    frame.good = false;
  };
  const std::string own = fmt::format("'{}'", draft.field.name);
  bool any = false;
  for (std::size_t i = draft.field.of.from; i <= draft.field.of.to; ++i) {
    Field& value = frame.fields[i].field;
    const bool exponent = value.kind == FieldKind::kExponent || value.kind == FieldKind::kDecimals;
    const bool signs_exponent = exponent && draft.field.kind == FieldKind::kSign &&
                                draft.field.of.from == draft.field.of.to;
    if (value.kind != FieldKind::kValue && !signs_exponent) continue;
    auto& target = draft.field.kind == FieldKind::kSign ? value.sign : value.exponent;
    any = true;
    if (target)
      return refuse(fmt::format("'{}' has two {}: '{}' and {}", value.name,
                                draft.field.kind == FieldKind::kSign ? "signs" : "exponents",
                                frame.fields[*target].field.name, own),
                    "one of them");
    if (!value.key.empty())
      return refuse(own + fmt::format(" is for '{}', which has a key", value.name),
                    "a value without a key");
    if (value.text_size != 0 &&
        (value.text_number.kind == TextNumber::Kind::kNone ||
         value.text_number.kind == TextNumber::Kind::kHex || value.text_number.decimals > 0))
      return refuse(
          own + fmt::format(" is for '{}', which is a text without a whole number", value.name),
          "text: decimal(6), or a picture without a point");
    target = static_cast<std::uint8_t>(at);
  }
  if (!any) refuse(own + " is for no value", "of: a field that is: value, or FIRST..LAST");
}

}  // namespace

namespace {

// The fields between the first and the last constant; with COBS, all before the last constant.
void set_escaped(DraftFrame& frame, declared::Escape escape, FaultList& faults) {
  const auto constant = [](const DraftField& draft) {
    return draft.field.kind == FieldKind::kConstant && !draft.shares;
  };
  const auto& fields = frame.fields;
  const auto first = std::ranges::find_if(fields, constant);
  std::size_t last = fields.size();
  while (last > 0 && !constant(fields[last - 1])) --last;
  const std::size_t from =
      escape == declared::Escape::kCobs ? 0 : static_cast<std::size_t>(first - fields.begin()) + 1;
  if (last < from + 2 || (from != 0 && first != fields.begin())) {
    faults.add(frame.position, "an escaped frame without marks",
               escape == declared::Escape::kCobs ? "a constant 0 at its end"
                                                 : "a constant at its begin and at its end");
    frame.good = false;
    return;
  }
  frame.escape = escape;
  frame.escaped = {static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(last - 2)};
}

}  // namespace

namespace {

bool has_key(const Node& map, std::string_view key) {
  return std::ranges::any_of(map.entries,
                             [&](const Node::Entry& entry) { return entry.key->text == key; });
}

// "cell" and "cell..unit" as "cell-3" and "cell-3..unit-3", if the group has these names.
std::string numbered_span(const std::string& of, const std::vector<std::string>& names,
                          const std::string& number) {
  const auto numbered = [&](const std::string& name) {
    return std::ranges::find(names, name) == names.end() ? name : name + number;
  };
  const auto dots = of.find("..");
  if (dots == of.npos) return numbered(of);
  return numbered(of.substr(0, dots)) + ".." + numbered(of.substr(dots + 2));
}

// { repeat: 16, fields: [...] }: the fields 16 times, their names with -1 to -16 behind them.
void append_group(DraftFrame& frame, const Node& node, const FieldDefaults& defaults,
                  unsigned item_bits, FaultList& faults) {
  MapReader map(node, kGroupKeys, faults);
  unsigned times = 0;
  frame.good = map.read_required("repeat", times, WholeRule{2, declared::kMaxFields},
                                 "how often the fields stand behind each other") &&
               frame.good;
  const Node* list = map.require("fields", "a list of fields");
  if (list == nullptr ||
      !is_list(*list, "fields", 1, declared::kMaxFields,
               fmt::format("a list of 1 to {} fields", declared::kMaxFields), faults)) {
    frame.good = false;
    return;
  }
  std::vector<DraftField> fields;
  std::vector<std::string> names;  // written ones
  for (const Node* item : list->items) {
    fields.push_back(read_field(*item, defaults, item_bits, faults));
    frame.good = frame.good && fields.back().fits;
    if (has_key(*item, "name")) names.push_back(fields.back().field.name);
  }
  if (!frame.good) return;
  for (unsigned i = 1; i <= times; ++i) {
    for (DraftField copy : fields) {
      const std::string number = fmt::format("-{}", i);
      if (!copy.of.empty()) copy.of = numbered_span(copy.of, names, number);
      if (std::ranges::find(names, copy.field.name) != names.end()) copy.field.name += number;
      frame.fields.push_back(std::move(copy));
    }
  }
}

}  // namespace

declared::Frame DraftFrame::frame() const {
  declared::Frame frame;
  for (const auto& draft : fields) frame.fields.push_back(draft.field);
  frame.block = block;
  frame.escape = escape;
  frame.escaped = escaped;
  return frame;
}

const DraftField* DraftFrame::find(FieldKind kind) const {
  for (const auto& draft : fields) {
    if (draft.field.kind == kind) return &draft;
  }
  return nullptr;
}

DraftFrame read_frame(const Node& node, std::string_view what, const FieldDefaults& defaults,
                      unsigned item_bits, FaultList& faults) {
  DraftFrame frame;
  frame.position = node.position;
  frame.block = defaults.block;
  frame.good = is_list(node, what, 1, declared::kMaxFields,
                       fmt::format("a list of 1 to {} fields", declared::kMaxFields), faults);
  if (!frame.good) return frame;
  for (const Node* item : node.items) {
    if (has_key(*item, "repeat") || has_key(*item, "fields")) {
      append_group(frame, *item, defaults, item_bits, faults);
      continue;
    }
    frame.fields.push_back(read_field(*item, defaults, item_bits, faults));
    frame.good = frame.good && frame.fields.back().fits;
  }
  if (frame.fields.size() > declared::kMaxFields) {
    faults.add(node.position,
               fmt::format("the frame has {} fields with its repetitions", frame.fields.size()),
               fmt::format("at most {}", declared::kMaxFields));
    frame.good = false;
  }
  const bool readable = frame.good;
  if (readable) Sharing(frame, defaults.high_first, faults).run();
  // Names in fields with faults may be incomplete.
  for (std::size_t i = 0; i < frame.fields.size() && readable; ++i) {
    resolve_span(frame, i, faults);
    check_number_end(frame, i, faults);
  }
  for (std::size_t i = 0; i < frame.fields.size() && frame.good; ++i) {
    if (declared::scales(frame.fields[i].field)) resolve_scaled(frame, i, faults);
  }
  if (readable && defaults.escape != declared::Escape::kNone)
    set_escaped(frame, defaults.escape, faults);
  return frame;
}

}  // namespace fieldcast::config

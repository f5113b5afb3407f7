#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"
#include "config/document/baud.hpp"
#include "config/document/common_forms.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {
namespace {

using declared::CheckKind;
using declared::Complement;
using declared::Field;
using declared::FieldKind;
using declared::Notation;

constexpr std::size_t kMaxRates = 32;

constexpr std::pair<std::string_view, Notation> kNotations[] = {{"binary", Notation::kBinary},
                                                                {"hex", Notation::kHex},
                                                                {"decimal", Notation::kDecimal},
                                                                {"bcd", Notation::kBcd},
                                                                {"channel", Notation::kChannel}};
constexpr std::pair<std::string_view, bool> kOrders[] = {{"big-endian", false},
                                                         {"little-endian", true}};
constexpr std::pair<std::string_view, bool> kOver[] = {{"characters", false}, {"bytes", true}};
constexpr std::pair<std::string_view, declared::Counts> kCounts[] = {
    {"bytes", declared::Counts::kBytes},
    {"characters", declared::Counts::kCharacters},
    {"items", declared::Counts::kItems}};
constexpr std::pair<std::string_view, Complement> kComplements[] = {
    {"none", Complement::kNone}, {"ones", Complement::kOnes}, {"twos", Complement::kTwos}};

class FieldReader {
 public:
  FieldReader(const Node& node, const FieldDefaults& defaults, unsigned item_bits,
              FaultList& faults)
      : map_(node, kFieldKeys, faults),
        faults_(faults),
        defaults_(defaults),
        item_bits_(item_bits),
        before_(faults.size()) {
    draft_.position = node.position;
  }

  DraftField run() {
    Field& field = draft_.field;
    read_kind();
    field.name = declared::to_text(field.kind);
    map_.read("name", field.name, NameRule{});
    field.word.notation = defaults_.notation;
    map_.read("as", field.word.notation, ChoiceRule<Notation>{kNotations});
    field.word.little_endian = defaults_.little_endian;
    map_.read("order", field.word.little_endian, ChoiceRule<bool>{kOrders});
    read_width();
    read_numbers();
    read_checksum();
    read_rates();
    read_key();
    read_optional();
    refuse_meaningless(map_, draft_.field.kind);
    draft_.fits = faults_.size() == before_;
    return std::move(draft_);
  }

 private:
  void read_kind() {
    Field& field = draft_.field;
    const Node* constant = map_.find("constant");
    const bool is = map_.read("is", field.kind, ChoiceRule<FieldKind>{declared::kFieldKinds});
    if (constant == nullptr) {
      if (!is && map_.is_map() && !map_.has_or_means("is") && !map_.has_or_means("constant"))
        faults_.add(map_.position(), "a field is neither constant nor anything else",
                    "constant: 0x55, or is: address, is: value, ...");
      return;
    }
    if (map_.has("is"))
      map_.fault("is", "a field is a constant and something else", "one of constant, is");
    if (constant->kind == Kind::kScalar && constant->quoted) {
      if (constant->text.empty() || constant->text.size() > 64)
        faults_.add(constant->position,
                    fmt::format("constant is {}", constant->text.empty() ? "empty" : "too long"),
                    "1 to 64 characters");
      field.text = constant->text;
    } else if (constant->kind == Kind::kList) {
      field.text = read_bytes(*constant, "constant");
    } else if (const auto number = WholeRule{0, INT64_MAX}(*constant, "constant", faults_)) {
      field.number = static_cast<std::uint64_t>(*number);
    }
  }

  // [0x10, 0x02].
  std::string read_bytes(const Node& list, std::string_view key) {
    std::string bytes;
    if (!is_list(list, key, 1, 64, "1 to 64 bytes", faults_)) return bytes;
    for (const Node* item : list.items) {
      if (const auto byte = WholeRule{0, 255}(*item, key, faults_))
        bytes += static_cast<char>(*byte);
    }
    return bytes;
  }

  // Also line breaks, as in constants.
  std::string read_characters(const Node& node, std::string_view key) {
    const std::string* text = scalar_of(node, key, "1 to 32 characters", faults_);
    if (text == nullptr) return {};
    if (text->empty() || text->size() > 32)
      faults_.add(node.position, fmt::format("{} is {}", key, text->empty() ? "empty" : "too long"),
                  "1 to 32 characters");
    return *text;
  }

  // A value of a block: the characters before it, the DIF and VIF of an M-Bus record, or a tag.
  void read_key() {
    const Node* key = map_.find("key");
    if (defaults_.block != declared::Block::kRecords)
      read_tag(key);
    else
      read_record_key(key);
    if (key != nullptr && (draft_.shares || draft_.field.variable))
      faults_.add(draft_.position, "a value with a key has bytes of its own",
                  "no bits, no variable");
  }

  void read_tag(const Node* key) {
    for (const auto* each : {"after", "until"}) {
      if (map_.find(each) != nullptr)
        map_.fault(each, fmt::format("'{}' has no meaning behind a tag", each),
                   "a length of the text");
    }
    if (key == nullptr) return;
    draft_.field.key =
        key->kind == Kind::kList ? read_bytes(*key, "key") : read_characters(*key, "key");
  }

  void read_record_key(const Node* key) {
    Field& field = draft_.field;
    const Node* until = map_.find("until");
    const bool is_text = field.text_size != 0;
    if (key != nullptr && field.kind == FieldKind::kUnused)
      faults_.add(key->position, "an unused field with a key",
                  "blocks: tag-value at the top of the file, or no such field");
    const Node* after = map_.find("after");
    for (const auto* each : {"after", "until"}) {
      if (map_.has(each) && (key == nullptr || !is_text))
        map_.fault(each, fmt::format("'{}' belongs to a text with a key", each), "key: and text:");
    }
    if (key == nullptr) return;
    if ((key->kind == Kind::kList) == is_text && map_.has("text") == is_text)
      faults_.add(key->position, is_text ? "the key of a text is a list" : "the key of a number",
                  "characters for a text, [DIF, VIF] for a number");
    else
      field.key = is_text ? read_characters(*key, "key") : read_bytes(*key, "key");
    field.until = ")";
    if (until != nullptr) field.until = read_characters(*until, "until");
    if (after != nullptr) field.after = read_characters(*after, "after");
    if (!is_text) field.until.clear();
    if (!is_text && field.key.size() == 1)
      faults_.add(key->position, "the key of an M-Bus record has one byte",
                  "[DIF, VIF], or blocks: tag-value at the top of the file");
  }

  // rates: { 0x30: 300, 0x35: 9600 }.
  void read_rates() {
    const Node* node = map_.find("rates");
    if (node == nullptr) return;
    Field& field = draft_.field;
    if (node->kind != Kind::kMap || node->entries.empty() || node->entries.size() > kMaxRates) {
      faults_.add(node->position, "rates is no list of baud rates",
                  fmt::format("1 to {} lines CODE: BAUD", kMaxRates));
      return;
    }
    for (const auto& [key, value] : node->entries) {
      const auto code = WholeRule{0, UINT32_MAX}(*key, "code", faults_);
      const auto baud = BaudRule{}(*value, "baud", faults_);
      if (!code || !baud) continue;
      too_wide(static_cast<std::uint64_t>(*code), key->position, "code");
      field.rates[static_cast<std::uint64_t>(*code)] = *baud;
    }
    if (!field.rates.empty() && !field.rates.contains(field.number))
      map_.fault(map_.has("fill") ? "fill" : "rates", "no usual code of a baud rate",
                 "fill: one of the codes in 'rates'");
  }

  // A constant that a response may omit.
  void read_optional() {
    bool optional = false;
    map_.read("optional", optional, FlagRule{});
    if (!optional || draft_.field.kind != FieldKind::kConstant) return;
    if (draft_.field.text.empty())
      map_.fault("optional", "an optional constant is a number", "characters, or a list of bytes");
    draft_.field.variable = true;
  }

  void read_width() {
    Field& field = draft_.field;
    unsigned bytes = 0, bits = 0, digits = 0;
    const bool bcd = field.word.notation == Notation::kBcd;
    const bool in_bytes = map_.read("bytes", bytes, WholeRule{1, bcd ? 9 : 8});
    const bool in_bits = map_.read("bits", bits, WholeRule{1, 64});
    const bool in_digits =
        map_.read("digits", digits, WholeRule{1, field.word.notation == Notation::kHex ? 16 : 18});
    read_text();
    const bool is_text = field.text_size != 0 || map_.has_or_means("text");
    map_.read("variable", is_text ? field.variable : field.word.variable, FlagRule{});
    draft_.width_position = map_.has("bytes")  ? map_.position_of("bytes")
                            : map_.has("bits") ? map_.position_of("bits")
                                               : map_.position_of("digits");
    check_width(in_digits);
    const bool bit_items = field.kind == FieldKind::kItems && item_bits_ == 1;
    read_items_width(bit_items, in_bytes || in_bits);
    if (field.kind == FieldKind::kItems && !bit_items && !(bcd && in_bytes))
      bytes = std::max(1u, item_bits_ / 8);
    if (!in_bits) bits = bytes != 0 ? 8 * bytes : 8;
    draft_.in_bits = in_bits;
    draft_.shares = in_bits && bits % 8 != 0;
    field.bits = static_cast<std::uint8_t>(bits);
    field.word.characters =
        static_cast<std::uint8_t>(field.word.notation == Notation::kHex ? bits / 4 : bits / 8);
    if (in_digits) set_digits(digits);
    if (bcd) set_bcd(bytes == 0 ? 1 : bytes);
    read_ascii_number();
  }

  // Digits of variable width, their sign, and the characters between items.
  void read_ascii_number() {
    Field& field = draft_.field;
    const bool decimal = field.word.notation == Notation::kDecimal;
    if (field.word.notation == Notation::kChannel && field.kind != FieldKind::kFirst &&
        field.kind != FieldKind::kLast)
      map_.fault("as", "'as: channel' is for the number of an item", "is: first, is: last");
    if (const Node* separator = map_.find("separator")) {
      field.separator = read_characters(*separator, "separator");
      if (field.packed)
        map_.fault("separator", "bits that share a byte have no separator", "on: 1, off: 0");
    }
    for (const auto* key : {"add", "xor", "order"}) {
      if ((field.word.variable || map_.has("separator")) && map_.has(key))
        map_.fault(key, fmt::format("'{}' has no meaning with 'variable' or 'separator'", key),
                   fmt::format("no '{}'", key));
    }
    if (!field.word.variable) return;
    field.word.little_endian = false;
    if (field.kind == FieldKind::kItems && !map_.has("separator"))
      map_.fault("variable", "items of variable width have no separator", "separator: \" \"");
    bool is_signed = false;
    const bool bits = field.kind == FieldKind::kItems && item_bits_ == 1;
    if (decimal && !bits && map_.read("signed", is_signed, FlagRule{}) && is_signed)
      field.word.sign_bits =
          static_cast<std::uint8_t>(field.kind == FieldKind::kItems ? item_bits_ : field.bits);
  }

  void set_bcd(unsigned bytes) {
    Field& field = draft_.field;
    map_.read("signed", field.is_signed, FlagRule{});
    const bool items = field.kind == FieldKind::kItems;
    if (map_.has("bits") || (items && item_bits_ < 8))
      faults_.add(map_.has("bits") ? draft_.width_position : draft_.position,
                  "packed decimal digits fill whole bytes", "bytes: 1 to 9");
    field.word.characters = static_cast<std::uint8_t>(bytes);
    field.word.sign_bits = field.is_signed ? 1 : 0;
    field.word.sign_digit =
        field.is_signed && defaults_.block == declared::Block::kRecords && map_.has("key");
    // A positive number uses all digits, also the one that may be the sign.
    declared::Word positive = field.word;
    if (field.word.sign_digit) positive.sign_bits = 0;
    const auto highest = declared::largest(positive);
    unsigned bits = field.is_signed ? 1 : 0;
    while (bits < 64 && highest >> bits != 0) ++bits;
    bits += field.is_signed ? 1 : 0;
    if (items && bits > item_bits_ && item_bits_ >= 8)
      faults_.add(
          draft_.position,
          fmt::format("items of {} bits are too narrow for {} digits", item_bits_, 2 * bytes),
          "fewer bytes, or a wider item of the area");
    field.bits = static_cast<std::uint8_t>(items && item_bits_ >= 8 ? item_bits_ : bits);
    if (field.is_signed) field.word.sign_bits = field.bits;
  }

  void check_width(bool in_digits) {
    const Field& field = draft_.field;
    const int widths = map_.has("bytes") + map_.has("bits") + map_.has("digits") +
                       map_.has("text") + !field.text.empty();
    if (widths > 1)
      faults_.add(draft_.position, "the width of a field is given twice",
                  "one of bytes, bits, digits, text");
    const bool ascii =
        field.word.notation != Notation::kBinary && field.word.notation != Notation::kBcd;
    if (field.word.variable && (!ascii || map_.has("bits")))
      map_.fault("variable", "only a text and ASCII digits can be variable",
                 "text: the most characters that it has, or digits: the most digits");
    if (in_digits &&
        (field.word.notation == Notation::kBinary || field.word.notation == Notation::kBcd))
      map_.fault("digits", "a binary field has no digits", "as: hex or as: decimal", "bytes");
    const bool decimal =
        field.word.notation == Notation::kDecimal || field.word.notation == Notation::kChannel;
    if (!in_digits && decimal && field.text.empty() && field.text_size == 0)
      faults_.add(draft_.position, "a decimal field does not say how many digits it has",
                  "digits: 1 to 18");
  }

  void read_items_width(bool bit_items, bool has_width) {
    Field& field = draft_.field;
    if (field.kind == FieldKind::kItems && !bit_items && has_width &&
        field.word.notation != Notation::kBcd)
      faults_.add(draft_.width_position, "the width of items is that of their area",
                  "no bytes, no bits");
    if (bit_items) field.packed = !map_.has("on") && !map_.has("off");
    if (field.packed && has_width)
      faults_.add(draft_.width_position, "bits stand eight in a byte",
                  "no width, or on and off for one that has a word of its own");
  }

  void set_digits(unsigned digits) {
    Field& field = draft_.field;
    field.word.characters = static_cast<std::uint8_t>(digits);
    field.bits = static_cast<std::uint8_t>(field.word.notation == Notation::kHex ? 4 * digits : 64);
    if (field.word.notation == Notation::kHex && field.word.little_endian && digits % 2 != 0)
      map_.fault("digits", "pairs of digits cannot be turned in an odd number",
                 "an even number of digits");
  }

  // text: 7, or a number written as text: decimal(7), "+000.00".
  void read_text() {
    const Node* node = map_.find("text");
    if (node == nullptr) return;
    const bool plain = node->kind != Kind::kScalar || node->text.starts_with('-') ||
                       (whole_from(node->text) && !node->text.starts_with("00"));
    if (plain) {
      if (const auto size = WholeRule{1, kMaxTextCharacters}(*node, "text", faults_))
        draft_.field.text_size = static_cast<std::uint16_t>(*size);
      return;
    }
    const auto form = TextFormRule{}(*node, "text", faults_);
    if (!form) return;
    if (form->characters == 0) {
      faults_.add(node->position,
                  fmt::format("text '{}' does not say how many characters it has", node->text),
                  kTextNumberForms, node->text + "(7)");
      return;
    }
    draft_.field.text_size = form->characters;
    draft_.field.text_number = form->number;
  }

  std::uint64_t most() const {
    const auto& field = draft_.field;
    return draft_.shares ? (std::uint64_t{1} << field.bits) - 1 : declared::largest(field.word);
  }
  void read_number(std::string_view key, std::uint64_t& target) {
    const Node* node = map_.find(key);
    if (node == nullptr) return;
    if (const auto number = WholeRule{0, INT64_MAX}(*node, key, faults_)) {
      target = static_cast<std::uint64_t>(*number);
      too_wide(target, node->position, key);
    }
  }
  void too_wide(std::uint64_t number, const Position& position, std::string_view key) {
    if (number > most())
      faults_.add(position, fmt::format("{} {} does not fit its field", key, number),
                  fmt::format("0 to {}, or a wider field", most()));
  }

  void read_numbers() {
    Field& field = draft_.field;
    if (map_.has("constant") && field.text.empty())
      too_wide(field.number, map_.position_of("constant"), "constant");
    const Node* plus = map_.find("plus");
    const bool counts_items = field.kind == FieldKind::kFirst || field.kind == FieldKind::kLast;
    if (plus != nullptr && plus->text == "origin" && counts_items)
      field.plus = defaults_.origin;
    else if (const auto number =
                 plus ? WholeRule{INT32_MIN, UINT32_MAX}(*plus, "plus", faults_) : std::nullopt)
      field.plus = *number;
    map_.read("times", field.times, WholeRule{1, 65535});
    read_number("on", field.on);
    read_number("off", field.off);
    if (map_.has("on") && field.on == field.off)
      map_.fault("on", "on and off are the same", "two numbers");
    read_number("ok", field.number);
    read_number("fill", field.number);
    map_.read("signed", field.is_signed, FlagRule{});
    if (field.kind == FieldKind::kItems && field.is_signed && field.word.sign_bits == 0)
      map_.fault("signed", "'signed' has no meaning for these items",
                 "as: bcd, as: decimal with variable: true, or a signed type of the channel");
    map_.read("counts", field.counts, ChoiceRule<declared::Counts>{kCounts});
    map_.read("add", field.transform.add, WholeRule{0, 255});
    map_.read("xor", field.transform.exor, WholeRule{0, 255});
    if (field.kind == FieldKind::kAddress) field.variable = field.text_size != 0;
    const bool measures = field.kind == FieldKind::kLength || field.kind == FieldKind::kChecksum ||
                          declared::scales(field);
    const Node* of = measures ? map_.require("of", "a field, or FIRST..LAST") : map_.find("of");
    if (of == nullptr) return;
    draft_.of_position = of->position;
    if (const auto* text = scalar_of(*of, "of", "a field, or FIRST..LAST", faults_))
      draft_.of = *text;
  }

  void read_checksum() {
    Field& field = draft_.field;
    const bool checks = field.kind == FieldKind::kChecksum;
    const Node* kind = checks ? map_.require("kind", check_words()) : map_.find("kind");
    if (kind != nullptr) {
      if (const auto check = read_check(*kind, faults_)) field.check = *check;
    }
    map_.read("complement", field.check.complement, ChoiceRule<Complement>{kComplements});
    map_.read("over", field.check.over_bytes, ChoiceRule<bool>{kOver});
    map_.read("start", field.check.start, WholeRule{0, UINT32_MAX});
    if (!checks || kind == nullptr) return;
    const bool crc = field.check.kind == CheckKind::kCrc;
    if (map_.has("start") && field.check.kind != CheckKind::kSum &&
        field.check.kind != CheckKind::kXor)
      map_.fault("start", "'start' at a checksum that is no sum and no xor",
                 "kind: sum, kind: xor; a CRC has start in its parameters");
    const bool decimal =
        field.word.notation == Notation::kDecimal && field.word.characters >= 3 && !crc;
    if (decimal) field.bits = 8;  // up to 255
    const unsigned needed = crc ? (field.check.crc.width + 7u) / 8 : 1;
    const bool fits = !draft_.shares && (decimal || field.word.notation != Notation::kDecimal) &&
                      field.word.notation != Notation::kBcd && field.bits % 8 == 0 &&
                      field.bits >= 8 * needed && field.bits <= (crc ? 64u : 32u);
    if (!fits)
      faults_.add(map_.has("bytes") || map_.has("bits") || map_.has("digits")
                      ? draft_.width_position
                      : kind->position,
                  kind->kind == Kind::kMap
                      ? std::string("a checksum of this CRC does not fit its field")
                      : fmt::format("a checksum {} does not fit its field", kind->text),
                  allowed_width(needed));
  }

  // `needed`: bytes of the checksum; 1 for those of any width.
  std::string allowed_width(unsigned needed) const {
    switch (draft_.field.word.notation) {
      case Notation::kHex:
        return needed == 1 ? "digits: 2, 4, 6 or 8" : fmt::format("digits: {}", 2 * needed);
      case Notation::kDecimal: return "digits: 3, for a sum or a xor";
      default: return needed == 1 ? "bytes: 1 to 4" : fmt::format("bytes: {}", needed);
    }
  }

  MapReader map_;
  FaultList& faults_;
  const FieldDefaults& defaults_;
  const unsigned item_bits_;
  const std::size_t before_;
  DraftField draft_;
};

}  // namespace

DraftField read_field(const Node& node, const FieldDefaults& defaults, unsigned item_bits,
                      FaultList& faults) {
  return FieldReader(node, defaults, item_bits, faults).run();
}

}  // namespace fieldcast::config

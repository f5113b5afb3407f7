#include "core/protocol/declared/reading.hpp"

#include <utility>

#include "core/protocol/declared/frame.hpp"
#include "core/protocol/declared/scaled.hpp"
#include "core/protocol/field_writer.hpp"

namespace fieldcast::declared {
namespace {

constexpr std::int64_t kWrongMark = 4;  // characters

class Reader {
 public:
  Reader(const Declaration& declaration, const Operation& operation, const DeclaredArea* area,
         const Frame& frame, ByteView bytes)
      : declaration_(declaration),
        operation_(operation),
        area_(area),
        frame_(frame),
        bytes_(bytes),
        item_bits_(area == nullptr ? 16 : area->item_bits) {
    context_.command = operation.command;
  }

  Reading run(const std::string& title, bool refusal, bool by_length) {
    writer_.remark(title);
    context_.refusal = refusal;
    unescape();
    const std::size_t fixed = size_of(frame_, item_bits_, 0) - variable();
    elastic_ = bytes_.size() > fixed ? bytes_.size() - fixed : 0;
    place();
    if (by_length) {
      elastic_ = stated_size().value_or(elastic_);
      place();
    }
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) show(frame_.fields[i], i);
    if (offset_ < bytes_.size())
      add(offset_, bytes_.size() - offset_, "rest", "", "bytes behind the end of the frame");
    reading_.fields = writer_.take();
    if (escaped_from_) {
      for (FrameField& field : reading_.fields) {
        const std::size_t end = on_wire(field.offset + field.length);
        field.offset = on_wire(field.offset);
        field.length = end - field.offset;
      }
    }
    return std::move(reading_);
  }

 private:
  void unescape() {
    const std::size_t offset = size_of(frame_, 0, frame_.escaped.from, item_bits_, 0);
    if (frame_.escape == Escape::kNone || offset > bytes_.size()) return;
    const Unescaped read = declared::unescape(frame_.escape, bytes_.subspan(offset));
    if (read.invalid) return add(offset + read.used, 1, "escape", "", "no escape of a byte");
    (void)unescape_from(frame_, offset, bytes_, plain_);
    escaped_from_ = offset;
    escaped_to_ = offset + read.plain.size();
    wire_ = std::exchange(bytes_, plain_);
  }
  // The place on the wire of a byte of `plain_`.
  std::size_t on_wire(std::size_t at) const {
    if (at <= *escaped_from_) return at;
    const std::size_t end = std::min(at, escaped_to_);
    if (frame_.escape == Escape::kCobs)
      return at - end + *escaped_from_ +
             escaped(frame_.escape, bytes_.subspan(*escaped_from_, end - *escaped_from_)).size();
    // Not by what would be sent: a sender may leave a byte as it is.
    std::size_t wire = *escaped_from_;
    for (std::size_t i = wire; i < end; ++i)
      wire += declared::unescape(frame_.escape, wire_.subspan(wire, 1)).plain.empty() ? 2 : 1;
    return at - end + wire;
  }
  // Equal bytes that wake a device up; receivers accept any number of them.
  static bool is_wake_up(const Field& field) {
    return field.kind == FieldKind::kConstant && field.text.size() > 1 &&
           field.text.find_first_not_of(field.text.front()) == std::string::npos;
  }
  std::size_t wake_up_size(const Field& field) const {
    const bool there =
        !bytes_.empty() && bytes_.front() == static_cast<std::uint8_t>(field.text.front());
    return there ? equal_bytes(bytes_) : 0;
  }
  std::size_t variable() const {
    std::size_t size = 0;
    for (const Field& field : frame_.fields) {
      if (field.variable) size += field.text.empty() ? field.text_size : field.text.size();
    }
    return size;
  }
  // A block extends to the constant behind it, or has a length before it.
  std::size_t block_size(std::size_t index, std::size_t at) const {
    const std::size_t end = block_end(frame_, index);
    std::size_t behind = 0;
    for (std::size_t i = end; i < frame_.fields.size(); ++i) behind += width(i, bytes_.size());
    if (at >= bytes_.size()) return 0;
    if (end < frame_.fields.size() && frame_.fields[end].kind == FieldKind::kConstant) {
      const Bytes mark = constant_characters(frame_.fields[end]);
      const auto rest = bytes_.subspan(at);
      const auto found = std::search(rest.begin(), rest.end(), mark.begin(), mark.end());
      if (found != rest.end()) return static_cast<std::size_t>(found - rest.begin());
    }
    return bytes_.size() - at > behind ? bytes_.size() - at - behind : 0;
  }
  // A variable text extends to the constant behind it; without one, its frame has no other.
  std::size_t width(std::size_t index, std::size_t at) const {
    const Field& field = frame_.fields[index];
    if (index == 0 && is_wake_up(field)) return wake_up_size(field);
    if (!field.key.empty()) return opens_block(frame_, index) ? block_size(index, at) : 0;
    if (field.variable && !field.text.empty()) {  // an optional constant
      const ByteView rest = bytes_.subspan(std::min(at, bytes_.size()));
      const bool there =
          rest.size() >= field.text.size() &&
          std::equal(field.text.begin(), field.text.end(), rest.begin(),
                     [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
      return there ? field.text.size() : 0;
    }
    const auto at_mark = field.variable ? mark_behind(frame_, index) : std::nullopt;
    if (at_mark && at < bytes_.size()) {
      const Field& constant = frame_.fields[*at_mark];
      Bytes mark = constant_characters(constant);
      for (std::uint8_t& each : mark) each = constant.transform.sent(each);
      const std::size_t between = size_of(frame_, index + 1, *at_mark, item_bits_, 0);
      const auto rest = bytes_.subspan(std::min(at + between, bytes_.size()));
      const auto end = std::search(rest.begin(), rest.end(), mark.begin(), mark.end());
      if (end != rest.end()) return static_cast<std::size_t>(end - rest.begin());
    }
    if (field.kind == FieldKind::kItems && !field.separator.empty())
      return separated(field, at).size;
    if (field.word.variable)
      return at < bytes_.size() ? width_of(bytes_.subspan(at), field.word) : 1;
    if (field.kind == FieldKind::kItems || field.variable) return elastic_;
    if (!field.text.empty()) return field.text.size();
    if (field.text_size != 0) return field.text_size;
    return field.opens ? field.word.characters : 0;
  }
  struct Separated {
    std::size_t size = 0;
    std::string text;   // the items with blanks between them
    bool valid = true;  // each is a number
  };
  // The items from `at` on, as far as a separator follows one.
  Separated separated(const Field& field, std::size_t at) const {
    Separated items;
    for (std::size_t end = std::min(at, bytes_.size());; end += field.separator.size()) {
      const ByteView left = bytes_.subspan(end);
      const std::size_t width = std::min(width_of(left, field.word), left.size());
      items.valid = items.valid && width >= (field.word.variable ? 1 : field.word.characters) &&
                    read_word(left.first(width), field.word);
      items.text += (items.text.empty() ? "" : " ") +
                    std::string(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(width));
      end += width;
      items.size = end - std::min(at, bytes_.size());
      const ByteView behind = bytes_.subspan(end);
      const bool more =
          behind.size() >= field.separator.size() &&
          std::equal(field.separator.begin(), field.separator.end(), behind.begin(),
                     [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
      if (!more) return items;
    }
  }
  void place() {
    starts_.clear();
    widths_.clear();
    std::size_t at = 0;
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) {
      starts_.push_back(at);
      widths_.push_back(width(i, at));
      at += widths_.back();
    }
    starts_.push_back(offset_ = at);
  }
  // The size of the field of variable length by the length field that covers it.
  std::optional<std::size_t> stated_size() const {
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) {
      const Field& length = frame_.fields[i];
      if (length.kind != FieldKind::kLength || starts_[i] + widths_[i] > bytes_.size()) continue;
      const auto word =
          read_word(length.transform.meant(bytes_.subspan(starts_[i], widths_[i])), length.word);
      if (!word || widths_[i] != length.word.characters) continue;
      for (std::size_t at = std::max(i + 1, std::size_t{length.of.from}); at <= length.of.to;
           ++at) {
        const Field& field = frame_.fields[at];
        if (field.kind != FieldKind::kItems && !(field.variable && field.text.empty())) continue;
        const auto others =
            counted(length) - declared::counted(field, length, widths_[at], item_bits_);
        const auto stated = (*word >> length.shift & (UINT64_MAX >> (64 - length.bits))) - others;
        if (stated > kMaxFrame) return std::nullopt;  // also if it is less than the others
        return characters_of_count(field, length, stated, item_bits_);
      }
    }
    return std::nullopt;
  }
  void add(std::size_t at, std::size_t length, const std::string& name, const std::string& value,
           const std::string& fault = {}) {
    if (!fault.empty()) refute(std::max<std::size_t>(1, length));
    writer_.add(at, length, name, value, fault);
  }
  void refute(std::size_t characters) {
    reading_.faultless = false;
    reading_.evidence -= static_cast<std::int64_t>(characters);
  }

  // A wrong mark or command weighs more than a wrong length or checksum.
  void prove(bool right, std::size_t size) {
    reading_.evidence += right ? static_cast<std::int64_t>(size) : -kWrongMark;
  }

  void show(const Field& field, std::size_t index) {
    if (!field.key.empty()) return block_value(field, index);
    std::size_t opener = index;
    while (opener > 0 && !frame_.fields[opener].opens) --opener;
    const std::size_t at = starts_[opener], size = widths_[opener];
    if (at + size > bytes_.size()) {
      const std::size_t have = std::min(at, bytes_.size());
      refute(at + size - std::max(at, bytes_.size()));
      return writer_.add(have, bytes_.size() - have, field.name, "",
                         "the frame ends before it is whole");
    }
    const Bytes part = frame_.fields[opener].transform.meant(bytes_.subspan(at, size));
    if (field.kind == FieldKind::kItems && !field.separator.empty()) {
      const Separated items = separated(field, at);
      return add(at, size, field.name, items.valid ? items.text : to_hex(part),
                 items.valid ? "" : "an item is not a number");
    }
    if (field.kind == FieldKind::kItems)
      return add(at, size, field.name, items(field, part),
                 size % field.word.characters == 0 ? "" : "the last item is not whole");
    if (field.scaled() && whole(field.exponent) && whole(field.sign)) {
      const auto decimal = scaled_value(frame_, index, bytes_, starts_);
      return add(at, size, field.name, decimal ? to_text(*decimal) : to_hex(part),
                 decimal ? "" : "no number");
    }
    if (!field.text.empty()) {
      if (field.variable && size == 0) return add(at, 0, field.name, "not in this frame");
      const bool right = std::ranges::equal(part, field.text, {}, {},
                                            [](char c) { return static_cast<std::uint8_t>(c); }) ||
                         (index == 0 && is_wake_up(field) && size > field.text.size());
      prove(right, size);
      return add(at, size, field.name, spelt(std::string(part.begin(), part.end())),
                 right ? "" : "should be " + spelt(field.text));
    }
    if (field.text_size != 0) {
      const std::string text(part.begin(), part.end());
      if (size > field.text_size) return add(at, size, field.name, text, "too long");
      return add(at, size, field.name, field.kind == FieldKind::kUnused ? spelt(text) : text);
    }
    const auto word = read_word(part, field.word);
    if (!word)
      return add(
          at, size, field.name, to_hex(part),
          field.word.variable ? "not a number of this field" : "a character that is no digit");
    number(field, at, size, *word >> field.shift & (UINT64_MAX >> (64 - field.bits)));
  }

  // Whether the field that scales or signs a value is in the frame.
  bool whole(const std::optional<std::uint8_t>& index) const {
    return !index || starts_[*index + 1u] <= bytes_.size();
  }

  void block_value(const Field& field, std::size_t index) {
    std::size_t opener = index;
    while (!opens_block(frame_, opener)) --opener;
    const std::size_t at = std::min(starts_[opener], bytes_.size());
    const auto block = bytes_.subspan(at, std::min(widths_[opener], bytes_.size() - at));
    const auto found = value_in_block(frame_, index, block);
    if (!found) return add(at, 0, field.name, "not in this frame");
    const auto where = static_cast<std::size_t>(found->data() - bytes_.data());
    if (field.text_size != 0 || field.kind == FieldKind::kUnused)
      return add(where, found->size(), field.name, std::string(found->begin(), found->end()));
    const auto number = read_word(*found, field.word);
    add(where, found->size(), field.name,
        number ? signed_text(*number, field.is_signed ? field.bits : 0) : to_hex(*found),
        number ? "" : "a character that is no digit");
  }

  // Decimal digits are shown as numbers, other items as on the wire.
  std::string items(const Field& field, const Bytes& part) const {
    const bool digits =
        field.word.notation == Notation::kHex || field.word.notation == Notation::kDecimal;
    if (!digits && (field.word.notation != Notation::kBcd || item_bits_ == 1)) return to_hex(part);
    std::string text;
    for (std::size_t at = 0; at + field.word.characters <= part.size();
         at += field.word.characters) {
      const auto item = ByteView(part).subspan(at, field.word.characters);
      const auto number = read_word(item, field.word);
      if (!number) return to_hex(part);
      text += (text.empty() ? "" : " ") + (digits ? std::string(item.begin(), item.end())
                                                  : signed_text(*number, field.word.sign_bits));
    }
    return text;
  }
  static std::string signed_text(std::uint64_t number, unsigned bits) {
    const bool negative = bits != 0 && (number >> (bits - 1) & 1u) != 0;
    return negative ? "-" + std::to_string((0 - number) & (UINT64_MAX >> (64 - bits)))
                    : std::to_string(number);
  }

  // Characters, or hexadecimal bytes if one of them cannot be printed or the frame is not a text.
  std::string spelt(const std::string& text) const {
    const auto prints = [](auto c) { return c >= ' ' && c <= '~'; };
    const bool in_text = std::ranges::count_if(bytes_, prints) * 2 > std::ssize(bytes_) &&
                         std::ranges::all_of(bytes_, [](auto c) { return c > 0 && c <= '~'; });
    return in_text && std::ranges::all_of(text, prints) ? text
                                                        : to_hex(Bytes(text.begin(), text.end()));
  }

  // A value without a numeric meaning is shown as on the wire.
  static std::string spelt(const Field& field, std::uint64_t number) {
    const bool mark = field.kind == FieldKind::kConstant || field.kind == FieldKind::kCommand ||
                      field.kind == FieldKind::kChecksum;
    const bool hex = field.word.notation == Notation::kHex;
    if (!mark || (!hex && field.word.notation != Notation::kBinary) ||
        field.bits != (hex ? 4u : 8u) * field.word.characters)
      return signed_text(number, field.is_signed ? field.bits : 0);
    Bytes bytes;
    append_word(bytes, field.word, number);
    return hex ? std::string(bytes.begin(), bytes.end()) : to_hex(bytes);
  }

  void number(const Field& field, std::size_t at, std::size_t size, std::uint64_t number) {
    std::string value = spelt(field, number), fault;
    const auto must = [&](std::uint64_t right) {
      if (number != right) fault = "should be " + spelt(field, right);
      if (number == right) prove(true, size);
    };
    switch (field.kind) {
      case FieldKind::kConstant:
      case FieldKind::kCommand:
        must(*number_of(field, context_));
        if (!fault.empty()) prove(false, size);
        break;
      case FieldKind::kFirst:
      case FieldKind::kLast:
      case FieldKind::kCount: range(field, number, value, fault); break;
      case FieldKind::kAddress: {
        const std::uint64_t address = without_plus(field, number);
        value = std::to_string(address);
        if (address < declaration_.lowest_address || address > declaration_.highest_address)
          fault = "no address of this protocol";
        break;
      }
      case FieldKind::kRate:
        if (const auto baud = field.rates.find(number); baud != field.rates.end())
          value += " = " + std::to_string(baud->second) + " baud";
        else if (!field.rates.empty())
          fault = "no baud rate has this code";
        break;
      case FieldKind::kChecksum:
        if (starts_[field.of.to + 1u] > bytes_.size()) {
          fault = "its fields are not whole";
        } else {
          must(check_of(field.check, field.bits, covered(frame_, field, bytes_, starts_)));
        }
        break;
      case FieldKind::kLength: {
        const std::uint64_t all = counted(field);
        // The last byte of packed bits may have some that do not count.
        const bool bits = field.counts == Counts::kItems && frame_.fields[field.of.from].packed;
        must(bits && number < all && all - number < 8 ? number : all);
        break;
      }
      case FieldKind::kError: {
        const auto known = declaration_.codes.find(static_cast<std::uint16_t>(number));
        if (known != declaration_.codes.end()) value += " " + known->second;
        if (context_.refusal == (number == field.number))
          fault = context_.refusal ? "no error" : "an error in a response";
        break;
      }
      default: break;
    }
    add(at, size, field.name, value, fault);
  }

  static std::uint64_t without_plus(const Field& field, std::uint64_t number) {
    return (number - static_cast<std::uint64_t>(field.plus)) & (UINT64_MAX >> (64 - field.bits));
  }
  // Shows the first or last item as its address, and checks it and a count.
  void range(const Field& field, std::uint64_t number, std::string& value, std::string& fault) {
    if (area_ == nullptr || area_->record || context_.refusal) return;
    const std::uint64_t items = without_plus(field, number) / field.times;
    if (without_plus(field, number) % field.times != 0) {
      fault = "should be a multiple of " + std::to_string(field.times);
    } else if (field.kind != FieldKind::kCount) {
      if (items < area_->items)
        value = item_text(*area_, static_cast<std::uint32_t>(items));
      else
        fault = "outside " + area_->name;
    } else if (items < operation_.min_count || items > operation_.max_count) {
      fault = "should be " + std::to_string(operation_.min_count) + ".." +
              std::to_string(operation_.max_count) + " items";
    } else {
      ++reading_.evidence;
    }
  }

  std::uint64_t counted(const Field& length) const {
    std::uint64_t total = static_cast<std::uint64_t>(length.plus);
    for (std::size_t i = length.of.from; i <= length.of.to; ++i) {
      const Field& field = frame_.fields[i];
      total += fieldcast::declared::counted(field, length, widths_[i], item_bits_);
    }
    return total;
  }

  const Declaration& declaration_;
  const Operation& operation_;
  const DeclaredArea* area_;
  const Frame& frame_;
  ByteView bytes_;  // with escaped fields: plain_
  ByteView wire_;
  Bytes plain_;
  const unsigned item_bits_;
  FrameContext context_;
  std::size_t elastic_ = 0;  // characters of the field of variable length
  std::size_t offset_ = 0;   // after the last field
  std::vector<std::size_t> starts_, widths_;
  std::optional<std::size_t> escaped_from_;  // of `plain_`; empty: not escaped
  std::size_t escaped_to_ = 0;
  FieldWriter writer_;
  Reading reading_;
};

}  // namespace

Reading read_frame(const Declaration& declaration, const Operation& operation,
                   const DeclaredArea* area, const Frame& frame, ByteView bytes,
                   const std::string& title, bool refusal, bool by_length) {
  return Reader(declaration, operation, area, frame, bytes).run(title, refusal, by_length);
}

}  // namespace fieldcast::declared

#include "tools/sim/device/declared_text.hpp"

#include <algorithm>
#include <array>

#include "tools/sim/device/declared_scale.hpp"
#include "tools/sim/device/declared_word.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using declared::Field;
using declared::FieldKind;
using declared::Frame;
using declared::Notation;

bool in_digits(const Field& field) {
  return field.word.notation == Notation::kHex && field.text.empty() && field.text_size == 0;
}

// Start of each field, and the end of the frame; fields of one word have the same start.
using Starts = std::array<std::size_t, declared::kMaxFields + 1>;

Bytes summed(const Frame& frame, const Field& sum, ByteView bytes, const Starts& starts) {
  Bytes covered;
  for (std::size_t i = sum.of.from; i <= sum.of.to; ++i) {
    Bytes part(bytes.begin() + static_cast<std::ptrdiff_t>(starts[i]),
               bytes.begin() + static_cast<std::ptrdiff_t>(starts[i + 1]));
    if (sum.check.over_bytes) part = frame.fields[i].transform.meant(part);
    const auto meant =
        sum.check.over_bytes && in_digits(frame.fields[i]) ? bytes_in(part) : std::nullopt;
    append(covered, meant ? *meant : part);
  }
  return covered;
}

std::size_t items_size(const Field& field, unsigned item_bits, std::uint64_t count) {
  return (item_bits == 1 && field.packed ? (count + 7) / 8 : count) * field.word.characters;
}

class ParseRun {
 public:
  ParseRun(const declared::Operation& operation, unsigned item_bits, ByteView bytes,
           std::string_view own_name)
      : own_name_(own_name),
        operation_(operation),
        fields_(operation.request.fields),
        item_bits_(item_bits),
        bytes_(bytes) {
    received_.text.command = operation.command;
    received_.text.count = operation.min_count;
  }

  DeclaredMatch run() {
    for (at_ = 0; at_ < fields_.size(); ++at_) {
      starts_[at_] = offset_;
      const Field& field = fields_[at_];
      if (!unescaped()) return std::move(received_);
      rest_ = field.transform.meant(bytes_.subspan(offset_));
      received_.fit = field.kind == FieldKind::kItems ? items(field)
                      : field.text_size != 0          ? text(field)
                      : !field.text.empty()           ? mark(field)
                                                      : word(field);
      if (received_.fit != Fit::kWhole) return std::move(received_);
    }
    starts_[at_] = offset_;
    fields_to_texts(operation_.request, received_.text);
    received_.size = offset_;  // an escaped frame is the whole rest
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const Field& field = fields_[i];
      if (field.kind != FieldKind::kChecksum) continue;
      const auto stated = number_of(
          field.transform.meant(bytes_.subspan(starts_[i], field.word.characters)), field.word);
      received_.bad_check |= stated != check_of(field.check, field.bits,
                                                summed(operation_.request, field, bytes_, starts_));
    }
    return std::move(received_);
  }

 private:
  using Fit = DeclaredMatch::Fit;

  // At the first escaped field: goes on with what they represent.
  bool unescaped() {
    const Frame& frame = operation_.request;
    if (frame.escape == declared::Escape::kNone || at_ != frame.escaped.from) return true;
    const auto read = declared::unescape(frame.escape, bytes_.subspan(offset_));
    received_.fit = read.invalid ? Fit::kNo : Fit::kMore;
    if (read.invalid || !read.ended) return false;
    plain_.assign(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset_));
    append(plain_, read.plain);
    append(plain_, bytes_.subspan(offset_ + read.used));
    bytes_ = plain_;
    return true;
  }
  ByteView rest() const { return rest_; }

  Fit mark(const Field& field) {
    const std::size_t present = std::min(rest().size(), field.text.size());
    if (!std::equal(field.text.begin(), field.text.begin() + static_cast<std::ptrdiff_t>(present),
                    rest().begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }))
      return Fit::kNo;
    offset_ += present;
    return present == field.text.size() ? Fit::kWhole : Fit::kMore;
  }

  Fit text(const Field& field) {
    std::size_t size = field.text_size;
    if (field.kind == FieldKind::kAddress && begins_with_own_name()) {
      size = own_name_.size();
    } else if (field.variable && given_size_) {
      size = std::min<std::size_t>(size, *given_size_);
    } else if (field.variable) {
      const Field& next = fields_[at_ + 1];
      if (next.kind != FieldKind::kConstant) return Fit::kNo;
      const Bytes end = next.text.empty() ? characters_of(next.number, next.word)
                                          : Bytes(next.text.begin(), next.text.end());
      const auto found = std::search(rest().begin(), rest().end(), end.begin(), end.end());
      if (found == rest().end()) return rest().size() >= size + end.size() ? Fit::kNo : Fit::kMore;
      size = static_cast<std::size_t>(found - rest().begin());
      if (size > field.text_size) return Fit::kNo;
    }
    if (rest().size() < size) return Fit::kMore;
    const std::string content(rest().begin(), rest().begin() + static_cast<std::ptrdiff_t>(size));
    if (field.kind == FieldKind::kAddress)
      received_.text.name = content;
    else if (field.kind == FieldKind::kValue)
      received_.text.texts[&field] = content;
    offset_ += size;
    return Fit::kWhole;
  }

  // Also as far as it arrived. The address of another device ends at the constant behind it.
  bool begins_with_own_name() const {
    const std::size_t size = std::min(own_name_.size(), rest().size());
    return !own_name_.empty() &&
           std::equal(rest().begin(), rest().begin() + static_cast<std::ptrdiff_t>(size),
                      own_name_.begin(),
                      [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); });
  }

  // Of a number that begins the bytes: whether its end is known.
  static Fit number_ends(ByteView bytes, const declared::Word& word) {
    const std::size_t length = number_length(bytes, word);
    if (!word.variable) return bytes.size() < length ? Fit::kMore : Fit::kWhole;
    if (length > word.characters + 1u) return Fit::kNo;
    return bytes.size() == length ? Fit::kMore : Fit::kWhole;
  }

  // Between separators: as many as the count says.
  Fit separated_items(const Field& field) {
    std::size_t at = 0;
    for (std::uint64_t i = 0; i < received_.text.count; ++i) {
      for (std::size_t n = 0; i != 0 && n < field.separator.size(); ++n, ++at) {
        if (at == rest().size()) return Fit::kMore;
        if (rest()[at] != static_cast<std::uint8_t>(field.separator[n])) return Fit::kNo;
      }
      const ByteView left = rest().subspan(at);
      if (const Fit fit = number_ends(left, field.word); fit != Fit::kWhole) return fit;
      const std::size_t length = number_length(left, field.word);
      const auto word = number_of(left.first(length), field.word);
      if (!word) return Fit::kNo;
      take_item(field, *word);
      at += length;
    }
    offset_ += at;
    return Fit::kWhole;
  }

  Fit items(const Field& field) {
    if (!field.separator.empty()) return separated_items(field);
    std::size_t size = items_size(field, item_bits_, received_.text.count);
    if (given_size_ && !counted_) {
      size = *given_size_;
      received_.text.count = counted_items_ != 0 ? counted_items_
                                                 : size / field.word.characters *
                                                       (item_bits_ == 1 && field.packed ? 8 : 1);
    } else if (given_size_) {
      received_.contradicts |= *given_size_ != size;
    }
    if (size > declared::kMaxFrame) return Fit::kNo;
    if (rest().size() < size) return Fit::kMore;
    for (std::size_t at = 0; at < size; at += field.word.characters) {
      const auto word = number_of(rest().subspan(at, field.word.characters), field.word);
      if (!word) return Fit::kNo;
      take_item(field, *word);
    }
    offset_ += size;
    return Fit::kWhole;
  }
  void take_item(const Field& field, std::uint64_t word) {
    auto& all = received_.text.items;
    if (item_bits_ != 1) return all.push_back(word);
    if (!field.packed) {
      received_.contradicts |= word != field.on && word != field.off;
      return all.push_back(word == field.on ? 1 : 0);
    }
    for (unsigned bit = 0; bit < 8 && all.size() < received_.text.count; ++bit)
      all.push_back(word >> bit & 1u);
  }

  Fit word(const Field& field) {
    if (field.opens) {
      if (const Fit fit = number_ends(rest(), field.word); fit != Fit::kWhole) return fit;
      width_ = number_length(rest(), field.word);
      const auto number = number_of(rest().first(width_), field.word);
      if (!number) return Fit::kNo;
      word_ = *number;
    }
    const bool fits = take(field, word_ >> field.shift & mask(field.bits));
    if (at_ + 1 == fields_.size() || fields_[at_ + 1].opens) offset_ += width_;
    return fits ? Fit::kWhole : Fit::kNo;
  }

  bool take(const Field& field, std::uint64_t number) {
    const std::uint64_t meant =
        (number - static_cast<std::uint64_t>(field.plus)) & mask(field.bits);
    DeclaredText& stated = received_.text;
    switch (field.kind) {
      case FieldKind::kConstant: return number == (field.number & mask(field.bits));
      case FieldKind::kCommand: return meant == (operation_.command & mask(field.bits));
      case FieldKind::kAddress: stated.address = meant; return true;
      case FieldKind::kFirst: stated.first = meant / field.times; return meant % field.times == 0;
      case FieldKind::kCount:
        stated.count = meant / field.times;
        counted_ = true;
        return meant % field.times == 0 && stated.count >= operation_.min_count &&
               stated.count <= operation_.max_count;
      case FieldKind::kLast: return meant % field.times == 0 && last(meant / field.times);
      case FieldKind::kSequence: stated.sequence = number; return true;
      case FieldKind::kRate: stated.rate = number; return true;
      case FieldKind::kLength: length(field, number); return true;
      case FieldKind::kValue:
      case FieldKind::kExponent:
      case FieldKind::kDecimals:
      case FieldKind::kSign: stated.numbers[&field] = number; return true;
      default: return true;
    }
  }

  // The first item is stated before the last one.
  bool last(std::uint64_t item) {
    counted_ = true;
    if (item < received_.text.first) return false;
    received_.text.count = item - received_.text.first + 1;
    return received_.text.count >= operation_.min_count &&
           received_.text.count <= operation_.max_count;
  }

  // Assigns the remaining length to the field of the span without a length of its own.
  void length(const Field& field, std::uint64_t number) {
    auto left = static_cast<std::int64_t>(number) - field.plus;
    const Field* open = nullptr;
    if (field.counts == declared::Counts::kItems) {
      received_.contradicts |= left < 1 || left > operation_.max_count;
      counted_items_ = static_cast<std::uint64_t>(std::max<std::int64_t>(left, 1));
      given_size_ = items_size(fields_[field.of.from], item_bits_, counted_items_);
      return;
    }
    const bool doubles = field.counts == declared::Counts::kBytes;
    for (std::size_t i = field.of.from; i <= field.of.to; ++i) {
      const Field& each = fields_[i];
      const bool halved = in_digits(each) && doubles;
      if (each.kind == FieldKind::kItems || each.variable) {
        open = &each;
      } else {
        const std::size_t size = !each.text.empty()    ? each.text.size()
                                 : each.text_size != 0 ? each.text_size
                                 : each.opens          ? each.word.characters
                                                       : 0;
        left -= static_cast<std::int64_t>(halved ? size / 2 : size);
      }
    }
    if (open == nullptr || left < 0) {
      received_.contradicts |= left != 0;
      return;
    }
    given_size_ = static_cast<std::size_t>(left) * (in_digits(*open) && doubles ? 2 : 1);
  }

  const std::string_view own_name_;
  const declared::Operation& operation_;
  const std::vector<Field>& fields_;
  const unsigned item_bits_;
  ByteView bytes_;
  Bytes plain_;
  DeclaredMatch received_;
  Starts starts_;  // up to the current field
  std::size_t at_ = 0, offset_ = 0;
  std::uint64_t word_ = 0;
  std::size_t width_ = 0;  // characters of word_
  std::optional<std::size_t> given_size_;
  std::uint64_t counted_items_ = 0;  // from a length in items
  Bytes rest_;                       // from the current field on, without its transform
  bool counted_ = false;
};

void append_items(Bytes& out, const Field& field, unsigned item_bits,
                  const std::vector<std::uint64_t>& items) {
  const std::size_t each = item_bits == 1 && field.packed ? 8 : 1;
  for (std::size_t at = 0; at < items.size(); at += each) {
    std::uint64_t word = items[at];
    if (each == 8) {
      for (std::size_t i = 1; i < std::min<std::size_t>(8, items.size() - at); ++i)
        word |= items[at + i] << i;
    } else if (item_bits == 1) {
      word = items[at] != 0 ? field.on : field.off;
    }
    if (at != 0) out.insert(out.end(), field.separator.begin(), field.separator.end());
    append(out, characters_of(word, field.word));
  }
}

std::uint64_t spoken(const Field& field, const DeclaredText& text) {
  const auto plus = static_cast<std::uint64_t>(field.plus);
  switch (field.kind) {
    case FieldKind::kAddress: return text.address + plus;
    case FieldKind::kCommand: return text.command + plus;
    case FieldKind::kFirst: return text.first * field.times + plus;
    case FieldKind::kCount: return text.count * field.times + plus;
    case FieldKind::kLast: return (text.first + text.count - 1) * field.times + plus;
    case FieldKind::kSequence: return text.sequence;
    case FieldKind::kError: return text.error != 0 ? text.error : field.number;
    case FieldKind::kLength:
    case FieldKind::kValue:
    case FieldKind::kExponent:
    case FieldKind::kDecimals:
    case FieldKind::kSign: {
      const auto found = text.numbers.find(&field);
      return found == text.numbers.end() ? 0 : found->second;
    }
    default: return field.number;
  }
}

}  // namespace

DeclaredMatch on_request(const declared::Declaration& declaration,
                         const declared::Operation& operation, ByteView bytes,
                         std::string_view own_name) {
  return ParseRun(operation, declaration.areas[operation.area].item_bits, bytes, own_name).run();
}

namespace {

// Behind a value of a block: a new line, or a blank if the block ends at a new line.
std::string_view between_values(const std::vector<Field>& fields, std::size_t at) {
  constexpr std::string_view kLine = "\r\n";
  while (at < fields.size() && !fields[at].key.empty()) ++at;
  const bool ends_at_line =
      at < fields.size() && !fields[at].text.empty() && kLine.find(fields[at].text) != kLine.npos;
  return ends_at_line ? " " : kLine;
}

Bytes tagged(const Frame& frame, const Field& field, const DeclaredText& text) {
  Bytes value;
  if (field.text_size == 0) {
    value = characters_of(spoken(field, text) & mask(field.bits), field.word);
  } else {
    const auto found = text.texts.find(&field);
    if (found != text.texts.end()) value.assign(found->second.begin(), found->second.end());
    value.resize(field.text_size, field.kind == FieldKind::kUnused ? blank_of(field) : 0);
  }
  Bytes part(field.key.begin(), field.key.end());
  if (frame.block == declared::Block::kTagLengthValue)
    part.push_back(static_cast<std::uint8_t>(value.size()));
  append(part, value);
  return part;
}

// Bytes of each field, without checksums. Parts of a word are in its first field.
std::vector<Bytes> parts_of(const Frame& frame, unsigned item_bits, const DeclaredText& text) {
  const auto& fields = frame.fields;
  std::vector<Bytes> parts(fields.size());
  std::uint64_t word = 0;
  std::size_t opened = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Field& field = fields[i];
    if (field.kind == FieldKind::kItems) {
      append_items(parts[i], field, item_bits, text.items);
    } else if (!field.text.empty()) {
      parts[i].assign(field.text.begin(), field.text.end());
    } else if (!field.key.empty() && frame.block != declared::Block::kRecords) {
      parts[i] = tagged(frame, field, text);
    } else if (!field.key.empty()) {
      parts[i].assign(field.key.begin(), field.key.end());
      if (field.text_size == 0) {
        append(parts[i], characters_of(spoken(field, text) & mask(field.bits), field.word));
        continue;
      }
      const auto found = text.texts.find(&field);
      const std::string content = found == text.texts.end() ? "" : found->second;
      const std::string line = field.after + content.substr(0, content.find('\0')) + field.until;
      const std::string_view between = between_values(fields, i);
      parts[i].insert(parts[i].end(), line.begin(), line.end());
      parts[i].insert(parts[i].end(), between.begin(), between.end());
    } else if (field.kind == FieldKind::kAddress && field.text_size != 0) {
      parts[i].assign(text.name.begin(), text.name.end());
    } else if (field.text_size != 0) {
      const auto found = text.texts.find(&field);
      if (found != text.texts.end()) parts[i].assign(found->second.begin(), found->second.end());
      if (!field.variable)
        parts[i].resize(field.text_size, field.kind == FieldKind::kUnused ? blank_of(field) : 0);
    } else {
      if (field.opens) word = 0, opened = i;
      word |= (spoken(field, text) & mask(field.bits)) << field.shift;
      parts[opened] = characters_of(word, field.word);
    }
  }
  return parts;
}

// The numbers of the length fields, from the bytes of the other fields.
void count_lengths(const Frame& frame, const std::vector<Bytes>& parts, DeclaredText& text) {
  const auto& fields = frame.fields;
  for (const Field& field : fields) {
    if (field.kind != FieldKind::kLength) continue;
    std::size_t length = 0;
    for (std::size_t of = field.of.from; of <= field.of.to; ++of) {
      const bool halved = in_digits(fields[of]) && field.counts == declared::Counts::kBytes;
      length += halved ? parts[of].size() / 2 : parts[of].size();
    }
    if (field.counts == declared::Counts::kItems) length = text.items.size();
    text.numbers[&field] = length + static_cast<std::uint64_t>(field.plus);
  }
}

// In order, because a later checksum may cover an earlier one.
void put_checksums(const Frame& frame, const Starts& starts, Bytes& out) {
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const Field& field = frame.fields[i];
    if (field.kind != FieldKind::kChecksum) continue;
    Bytes sum = characters_of(check_of(field.check, field.bits, summed(frame, field, out, starts)),
                              field.word);
    for (std::uint8_t& byte : sum) byte = field.transform.sent(byte);
    std::ranges::copy(sum, out.begin() + static_cast<std::ptrdiff_t>(starts[i]));
  }
}

}  // namespace

Bytes say(const Frame& frame, unsigned item_bits, DeclaredText text) {
  texts_to_fields(frame, text);
  count_lengths(frame, parts_of(frame, item_bits, text), text);
  std::vector<Bytes> parts = parts_of(frame, item_bits, text);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::uint8_t& byte : parts[i]) byte = frame.fields[i].transform.sent(byte);
  }
  Starts starts{};
  Bytes out;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    starts[i] = out.size();
    append(out, parts[i]);
    starts[i + 1] = out.size();
  }
  put_checksums(frame, starts, out);
  if (frame.escape == declared::Escape::kNone) return out;
  const std::size_t from = starts[frame.escaped.from], to = starts[frame.escaped.to + 1u];
  Bytes sent(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(from));
  append(sent, declared::escaped(frame.escape, ByteView(out).subspan(from, to - from)));
  append(sent, ByteView(out).subspan(to));
  return sent;
}

}  // namespace fieldcast::sim

#include "core/protocol/declared/frame.hpp"

#include <algorithm>

#include "core/codec/digits.hpp"
#include "core/protocol/declared/scaled.hpp"

namespace fieldcast::declared {
namespace {

bool in_digits(const Field& field) {
  return field.word.notation == Notation::kHex && field.text.empty() && field.text_size == 0;
}

std::size_t characters_of(const Field& field, unsigned item_bits, std::uint32_t count) {
  if (field.kind == FieldKind::kItems) return items_size(field, item_bits, count);
  if (!field.text.empty()) return field.text.size();
  if (!field.key.empty()) {  // with the length of a tag, or the end of a line behind a text
    return field.key.size() + 1 +
           (field.text_size != 0 ? field.text_size + field.after.size() + field.until.size() + 2
                                 : field.word.characters);
  }
  if (field.text_size != 0) return field.text_size;
  return field.opens ? most_characters(field.word) : 0;
}

std::uint64_t length_of(const Frame& frame, const Field& length, unsigned item_bits,
                        std::uint32_t count) {
  std::uint64_t total = 0;
  for (std::size_t i = length.of.from; i <= length.of.to; ++i) {
    const Field& field = frame.fields[i];
    total += length.counts == Counts::kItems
                 ? count
                 : counted(field, length, characters_of(field, item_bits, count), item_bits);
  }
  return total + static_cast<std::uint64_t>(length.plus);
}

void append_value(Bytes& out, const Field& field, const FrameContext& context,
                  std::uint64_t& word) {
  const std::size_t items = items_of(field), at = field.place - context.first;
  if (field.text_size != 0) {
    for (std::size_t i = 0; i < field.text_size; ++i) out.push_back(context.items[2 * at + i]);
    return;
  }
  word |= (value_in(context.items, at, items) & (UINT64_MAX >> (64 - field.bits))) << field.shift;
}

std::map<std::size_t, std::uint64_t> numbers_to_scale(const Frame& frame,
                                                      const FrameContext& context) {
  if (std::ranges::none_of(frame.fields, &Field::scaled)) return {};
  return scaled_numbers(frame, context.items, context.first)
      .value_or(std::map<std::size_t, std::uint64_t>{});
}

void append_scaled_text(Bytes& out, const Field& field, std::uint64_t number) {
  const bool negative = !field.sign && number >> 63 != 0;
  const auto text =
      write_decimal(field.text_number, field.text_size,
                    negative ? Value{static_cast<std::int64_t>(number)} : Value{number}, false);
  const std::string characters = text.value_or(std::string(field.text_size, '0'));
  out.insert(out.end(), characters.begin(), characters.end());
}

}  // namespace

std::uint64_t value_in(ByteView image, std::size_t at, std::size_t items) {
  std::uint64_t value = 0;
  for (std::size_t i = 2 * at; i < 2 * (at + items); ++i) value = value << 8 | image[i];
  return value;
}

std::uint64_t counted(const Field& field, const Field& length, std::size_t characters,
                      unsigned item_bits) {
  if (length.counts == Counts::kItems)
    return characters / field.word.characters * (item_bits == 1 && field.packed ? 8 : 1);
  return in_digits(field) && length.counts == Counts::kBytes ? characters / 2 : characters;
}

std::size_t characters_of_count(const Field& field, const Field& length, std::uint64_t count,
                                unsigned item_bits) {
  if (length.counts == Counts::kItems)
    return items_size(field, item_bits, static_cast<std::uint32_t>(count));
  return static_cast<std::size_t>(count) *
         (in_digits(field) && length.counts == Counts::kBytes ? 2 : 1);
}

std::size_t items_size(const Field& field, unsigned item_bits, std::uint32_t count) {
  if (item_bits == 1 && field.packed) return (count + 7) / 8 * field.word.characters;
  const std::size_t separators = count == 0 ? 0 : count - 1;
  return count * most_characters(field.word) + separators * field.separator.size();
}

std::size_t size_of(const Frame& frame, std::size_t from, std::size_t to, unsigned item_bits,
                    std::uint32_t count) {
  std::size_t size = 0;
  for (std::size_t i = from; i < to; ++i) size += characters_of(frame.fields[i], item_bits, count);
  return size;
}

std::optional<std::uint64_t> number_of(const Field& field, const FrameContext& context) {
  const auto plus = static_cast<std::uint64_t>(field.plus);
  const auto narrow = [&](std::uint64_t number) {
    return number & (UINT64_MAX >> (64 - field.bits));
  };
  switch (field.kind) {
    case FieldKind::kConstant: return narrow(field.number);
    case FieldKind::kAddress: return narrow(context.address + plus);
    case FieldKind::kCommand: return narrow(context.command + plus);
    case FieldKind::kFirst: return narrow(std::uint64_t{context.first} * field.times + plus);
    case FieldKind::kCount: return narrow(std::uint64_t{context.count} * field.times + plus);
    case FieldKind::kLast:
      return narrow((std::uint64_t{context.first} + context.count - 1) * field.times + plus);
    case FieldKind::kSequence: return narrow(context.sequence);
    case FieldKind::kRate: return context.rate;
    default: return std::nullopt;
  }
}

std::optional<Unescaped> unescape_from(const Frame& frame, std::size_t offset, ByteView bytes,
                                       Bytes& plain) {
  Unescaped read = unescape(frame.escape, bytes.subspan(offset));
  if (read.invalid) return std::nullopt;
  plain.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  append(plain, read.plain);
  if (read.ended) append(plain, bytes.subspan(offset + read.used));
  return read;
}

std::optional<std::size_t> mark_behind(const Frame& frame, std::size_t at) {
  for (std::size_t i = at + 1; i < frame.fields.size(); ++i) {
    const Field& field = frame.fields[i];
    const bool digits =
        field.word.notation == Notation::kHex || field.word.notation == Notation::kDecimal;
    if (field.kind == FieldKind::kConstant && !field.variable && field.opens &&
        (digits || field.bits % 8 == 0)) {
      const bool among_digits = i > at + 1 && hex_digit(constant_characters(field)[0]) >= 0;
      return among_digits ? std::nullopt : std::optional(i);
    }
    if (!digits || field.word.variable || field.kind == FieldKind::kItems || field.text_size != 0 ||
        !field.text.empty() || !field.key.empty())
      return std::nullopt;
  }
  return std::nullopt;
}

Bytes constant_characters(const Field& constant) {
  Bytes characters(constant.text.begin(), constant.text.end());
  if (characters.empty()) append_word(characters, constant.word, constant.number);
  return characters;
}

void append_items(Bytes& out, const Field& field, unsigned item_bits, ByteView items) {
  if (item_bits == 1 && field.packed) {
    for (std::size_t at = 0; at < items.size(); at += 8) {
      std::uint64_t byte = 0;
      for (std::size_t i = at; i < std::min(at + 8, items.size()); ++i)
        byte |= (items[i] != 0 ? 1u : 0u) << (i - at);
      append_word(out, field.word, byte);
    }
    return;
  }
  const std::size_t width = image_bytes(item_bits, 1);
  for (std::size_t at = 0; at < items.size(); at += width) {
    if (at != 0) out.insert(out.end(), field.separator.begin(), field.separator.end());
    std::uint64_t item = 0;
    for (std::size_t i = at; i < at + width; ++i) item = item << 8 | items[i];
    append_word(out, field.word, item_bits == 1 ? (item != 0 ? field.on : field.off) : item);
  }
}

std::optional<Bytes> read_items(ByteView characters, const Field& field, unsigned item_bits,
                                std::uint32_t count) {
  Bytes items;
  const bool packed = item_bits == 1 && field.packed;
  const std::size_t width = field.word.variable ? characters.size() : field.word.characters;
  for (std::size_t at = 0; at < characters.size(); at += width) {
    const auto word = read_word(characters.subspan(at, width), field.word);
    // Decimal digits can exceed the bits of an item.
    if (!word || (item_bits > 1 && *word > UINT64_MAX >> (64 - item_bits))) return std::nullopt;
    if (packed) {
      for (unsigned bit = 0; bit < 8 && items.size() < count; ++bit)
        items.push_back(static_cast<std::uint8_t>(*word >> bit & 1));
    } else if (item_bits == 1) {
      if (*word != field.on && *word != field.off) return std::nullopt;
      items.push_back(*word == field.on ? 1 : 0);
    } else {
      for (std::size_t i = image_bytes(item_bits, 1); i-- > 0;)
        items.push_back(static_cast<std::uint8_t>(*word >> 8 * i));
    }
  }
  return items;
}

Bytes covered(const Frame& frame, const Field& sum, ByteView bytes,
              std::span<const std::size_t> starts) {
  const ByteView all =
      bytes.subspan(starts[sum.of.from], starts[sum.of.to + 1u] - starts[sum.of.from]);
  if (!sum.check.over_bytes) return {all.begin(), all.end()};
  Bytes meant;
  for (std::size_t i = sum.of.from; i <= sum.of.to; ++i) {
    const Field& field = frame.fields[i];
    const Bytes characters =
        field.transform.meant(bytes.subspan(starts[i], starts[i + 1] - starts[i]));
    const ByteView part = characters;
    const bool digits = in_digits(field) && part.size() % 2 == 0;
    const Word byte{Notation::kHex, 2, false};
    for (std::size_t at = 0; at < part.size(); at += digits ? 2 : 1)
      meant.push_back(static_cast<std::uint8_t>(
          digits ? read_word(part.subspan(at, 2), byte).value_or(0) : part[at]));
  }
  return meant;
}

namespace {

// Transforms, checks and escapes the frame that begins at `begin`. `starts`: of its fields.
void seal(Bytes& out, std::size_t begin, const Frame& frame,
          const std::vector<std::size_t>& starts) {
  const auto& fields = frame.fields;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (!fields[i].transform) continue;
    for (std::size_t at = begin + starts[i]; at < begin + starts[i + 1]; ++at)
      out[at] = fields[i].transform.sent(out[at]);
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].kind != FieldKind::kChecksum) continue;
    Bytes sum;
    append_word(sum, fields[i].word,
                check_of(fields[i].check, fields[i].bits,
                         covered(frame, fields[i], ByteView(out).subspan(begin), starts)));
    for (std::uint8_t& byte : sum) byte = fields[i].transform.sent(byte);
    std::copy(sum.begin(), sum.end(), out.begin() + static_cast<std::ptrdiff_t>(begin + starts[i]));
  }
  if (frame.escape == Escape::kNone) return;
  const auto from = out.begin() + static_cast<std::ptrdiff_t>(begin + starts[frame.escaped.from]);
  const auto to = out.begin() + static_cast<std::ptrdiff_t>(begin + starts[frame.escaped.to + 1u]);
  Bytes tail = escaped(frame.escape, ByteView(from, to));
  tail.insert(tail.end(), to, out.end());
  out.erase(from, out.end());
  append(out, tail);
}

}  // namespace

void append_frame(Bytes& out, const Frame& frame, const FrameContext& context) {
  const auto& fields = frame.fields;
  const std::size_t begin = out.size();
  std::vector<std::size_t> starts;
  const auto scaled = numbers_to_scale(frame, context);
  std::uint64_t word = 0;  // of the fields that share it
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Field& field = fields[i];
    starts.push_back(out.size() - begin);
    if (field.kind == FieldKind::kItems) {
      append_items(out, field, context.item_bits, context.items);
      continue;
    }
    if (!field.text.empty()) {
      out.insert(out.end(), field.text.begin(), field.text.end());
      continue;
    }
    if (field.opens) word = 0;
    if (field.kind == FieldKind::kUnused && field.text_size != 0) {
      out.insert(out.end(), field.variable ? 0 : field.text_size, blank_of(field));
      continue;
    }
    if (const auto sent = scaled.find(i); sent != scaled.end()) {
      if (field.text_size != 0) {
        append_scaled_text(out, field, sent->second);
        continue;
      }
      word |= (sent->second & (UINT64_MAX >> (64 - field.bits))) << field.shift;
    } else if (field.kind == FieldKind::kValue) {
      append_value(out, field, context, word);
      if (field.text_size != 0) continue;
    } else if (field.kind == FieldKind::kLength) {
      word |= length_of(frame, field, context.item_bits, context.count) << field.shift;
    } else if (field.kind == FieldKind::kUnused || field.kind == FieldKind::kError) {
      word |= field.number << field.shift;
    } else {
      word |= number_of(field, context).value_or(0) << field.shift;
    }
    // The first field of a shared word reserves its characters; the last one completes its number.
    if (field.opens) out.resize(out.size() + field.word.characters);
    if (i + 1 == fields.size() || fields[i + 1].opens) {
      out.resize(out.size() - field.word.characters);
      append_word(out, field.word, word);
    }
  }
  starts.push_back(out.size() - begin);
  seal(out, begin, frame, starts);
}

}  // namespace fieldcast::declared

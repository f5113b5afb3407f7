#include "tools/cli/inspect/learn/field_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "core/codec/digits.hpp"

namespace fieldcast::learn {

using declared::FieldKind;

bool FieldLayout::is_free(std::ptrdiff_t at, std::size_t width) const {
  const auto end = at + static_cast<std::ptrdiff_t>(width);
  return at >= 0 && end <= end_ && std::ranges::none_of(fields_, [&](const LearnedField& field) {
           return field.at < end && at < field.at + static_cast<std::ptrdiff_t>(field.width);
         });
}

bool FieldLayout::add(LearnedField field) {
  if (field.width == 0 || !is_free(field.at, field.width)) return false;
  fields_.push_back(std::move(field));
  return true;
}

std::ptrdiff_t FieldLayout::used() const {
  std::ptrdiff_t end = 0;
  for (const LearnedField& field : fields_)
    end = std::max(end, field.at + static_cast<std::ptrdiff_t>(field.width));
  return end;
}

bool FieldLayout::is_varying(std::ptrdiff_t column) const {
  return !constant_at(frames_, column).has_value();
}

void FieldLayout::fill(FieldKind others, const std::string& note) {
  for (std::ptrdiff_t at = 0; at < end_; ++at) {
    if (!is_free(at, 1)) continue;
    const bool varying = is_varying(at);
    std::ptrdiff_t end = at + 1;
    while (is_free(end, 1) && is_varying(end) == varying && !cuts_.contains(end) &&
           end - at < (varying ? 8 : 64))
      ++end;
    LearnedField field = constant_field(frames_, at, static_cast<std::size_t>(end - at));
    if (varying) {
      field.kind = others;
      field.note = note;
      field.word = text_ ? digits(declared::Notation::kHex, field.width)
                         : binary(static_cast<unsigned>(field.width));
      if (text_ && !is_hex(at, end)) field.text = static_cast<unsigned>(field.width);
    }
    fields_.push_back(std::move(field));
  }
}

std::vector<LearnedField> FieldLayout::take() {
  std::ranges::sort(fields_, {}, &LearnedField::at);
  return std::move(fields_);
}

bool FieldLayout::is_hex(std::ptrdiff_t at, std::ptrdiff_t end) const {
  for (; at < end; ++at) {
    if (!std::ranges::all_of(values_at(frames_, at), [](auto c) { return hex_digit(c) >= 0; }))
      return false;
  }
  return true;
}

LearnedField constant_field(const Frames& frames, std::ptrdiff_t at, std::size_t width) {
  LearnedField field{.kind = FieldKind::kConstant, .at = at, .width = width};
  for (std::size_t i = 0; i < width; ++i)
    field.constant.push_back(constant_at(frames, at + static_cast<std::ptrdiff_t>(i)).value_or(0));
  for (const ByteView frame : frames) {
    const auto has = [&](std::size_t i) {
      return byte_at(frame, at + static_cast<std::ptrdiff_t>(i)) == field.constant[i];
    };
    std::size_t same = 0;
    while (same < width && has(same)) ++same;
    ++field.evidence.of;
    if (same == width) ++field.evidence.holds;
  }
  return field;
}

std::string word_of(FieldKind kind) {
  static constexpr const char* kWords[] = {"constant", "address",  "command", "first", "count",
                                           "last",     "length",   "items",   "value", "checksum",
                                           "error",    "sequence", "unused"};
  return kWords[static_cast<std::size_t>(kind)];
}

void name_fields(std::vector<LearnedField>& fields) {
  std::map<std::string, unsigned> counts;
  for (LearnedField& field : fields) {
    const std::string word = word_of(field.kind);
    const unsigned count = ++counts[word];
    const bool alone = count == 1 && field.kind != FieldKind::kValue;
    // The values of a declaration get their names later, when those of all operations are known.
    field.name =
        alone ? word
              : fmt::format("{}{}{}", word, field.kind == FieldKind::kValue ? '.' : '-', count);
  }
}

namespace {

// A number, or other characters with blanks behind them.
struct Token {
  bool number = false;
  std::size_t size = 0;
  std::size_t blanks = 0;  // behind a token that is not a number
};

bool is_number_character(std::uint8_t c) {
  return is_decimal_digit(c) || c == '.' || c == '+' || c == '-';
}

std::vector<Token> tokens_of(ByteView text) {
  std::vector<Token> tokens;
  for (std::size_t i = 0; i < text.size();) {
    Token token{is_number_character(text[i])};
    const std::size_t begin = i;
    // A sign begins a number, also directly behind a number.
    while (i < text.size() && is_number_character(text[i]) == token.number &&
           !(token.number && i > begin && (text[i] == '+' || text[i] == '-')))
      ++i;
    token.size = i - begin;
    while (!token.number && token.blanks < token.size && text[i - 1 - token.blanks] == ' ')
      ++token.blanks;
    tokens.push_back(token);
  }
  return tokens;
}

class TextValues {
 public:
  TextValues(const Frames& frames, std::size_t at, std::size_t end_size) : at_(at) {
    for (const ByteView frame : frames) {
      if (frame.size() < at + end_size) continue;
      texts_.push_back(frame.subspan(at, frame.size() - at - end_size));
      rows_.push_back(tokens_of(texts_.back()));
    }
  }

  std::vector<LearnedField> run() {
    if (rows_.empty()) return {};
    for (const auto& row : rows_) {
      if (!std::ranges::equal(row, rows_.front(), {}, &Token::number, &Token::number)) return {};
    }
    begins_.assign(rows_.size(), 0);
    for (std::size_t i = 0; i < rows_.front().size(); ++i)
      rows_.front()[i].number ? add_number(i) : add_other(i);
    // Only the constant behind a variable text shows its end.
    for (std::size_t i = 0; i + 1 < fields_.size(); ++i) {
      if (fields_[i].variable && fields_[i + 1].kind != declared::FieldKind::kConstant) return {};
    }
    return std::move(fields_);
  }

 private:
  [[nodiscard]] bool same(std::size_t token, std::size_t Token::*member) const {
    return std::ranges::all_of(
        rows_, [&](const auto& row) { return row[token].*member == rows_[0][token].*member; });
  }

  // Fewer blanks before more digits: the number has a fixed width.
  [[nodiscard]] bool aligned(std::size_t number) const {
    if (number == 0 || number >= rows_[0].size() || same(number, &Token::size)) return false;
    const auto width = [&](const auto& row) { return row[number - 1].blanks + row[number].size; };
    return std::ranges::all_of(rows_,
                               [&](const auto& row) { return width(row) == width(rows_[0]); });
  }
  [[nodiscard]] std::size_t blanks_of(std::size_t row, std::size_t number) const {
    return aligned(number) ? rows_[row][number - 1].blanks - least_blanks(number - 1) : 0;
  }
  [[nodiscard]] std::size_t least_blanks(std::size_t token) const {
    return std::ranges::min(rows_, {}, [&](const auto& row) { return row[token].blanks; })[token]
        .blanks;
  }

  // A number that never changes is rather a code, such as that of OBIS.
  void add_number(std::size_t i) {
    const auto all = [&](std::size_t row) {
      return texts_[row].subspan(begins_[row], rows_[row][i].size + blanks_of(row, i));
    };
    bool constant = true;
    for (std::size_t row = 0; row < rows_.size(); ++row)
      constant = constant && std::ranges::equal(all(row), all(0));
    if (constant && rows_.size() > 1) {
      add_constant(all(0));
      return skip([&](std::size_t row) { return all(row).size(); });
    }
    std::size_t most = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row)
      most = std::max(most, rows_[row][i].size + blanks_of(row, i));
    add({.kind = declared::FieldKind::kValue,
         .text = static_cast<unsigned>(most),
         .decimal = true,
         .variable = !aligned(i) && !same(i, &Token::size)});
    skip([&](std::size_t row) { return rows_[row][i].size + blanks_of(row, i); });
  }

  // What all have at its beginning and end is constant, and something between them a value.
  void add_other(std::size_t i) {
    const auto part = [&](std::size_t row) {
      return texts_[row].subspan(begins_[row], rows_[row][i].size - blanks_of(row, i + 1));
    };
    std::size_t head = 0, tail = 0, least = SIZE_MAX, most = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row)
      least = std::min(least, part(row).size()), most = std::max(most, part(row).size());
    const auto agree = [&](std::ptrdiff_t at) {
      for (std::size_t row = 1; row < rows_.size(); ++row) {
        if (byte_at(part(row), at) != byte_at(part(0), at)) return false;
      }
      return true;
    };
    while (head < least && agree(static_cast<std::ptrdiff_t>(head))) ++head;
    while (head + tail < least && agree(-1 - static_cast<std::ptrdiff_t>(tail))) ++tail;
    if (least != most) keep_words(part(0), head, tail);
    add_constant(part(0).first(head));
    if (head < most && head + tail < most && most - head - tail == 1 && least == most)
      add({.kind = declared::FieldKind::kValue, .width = 1, .word = binary(1)});
    else if (head < most && head + tail < most)
      add({.kind = declared::FieldKind::kValue,
           .text = static_cast<unsigned>(most - head - tail),
           .variable = least != most});
    add_constant(part(0).last(tail));
    skip([&](std::size_t row) { return part(row).size(); });
  }

  // "kg" and "g" have no common end.
  static void keep_words(ByteView text, std::size_t& head, std::size_t& tail) {
    const auto is_letter = [](std::uint8_t c) { return std::isalnum(c) != 0; };
    while (head > 0 && is_letter(text[head - 1])) --head;
    while (tail > 0 && is_letter(text[text.size() - tail])) --tail;
  }

  void add_constant(ByteView bytes) {
    if (bytes.empty()) return;
    if (!fields_.empty() && fields_.back().kind == declared::FieldKind::kConstant &&
        fields_.back().width + bytes.size() <= 64) {
      append(fields_.back().constant, bytes);
      fields_.back().width += bytes.size();
      offset_ += bytes.size();
      return;
    }
    LearnedField field{.kind = declared::FieldKind::kConstant, .width = bytes.size()};
    field.constant.assign(bytes.begin(), bytes.end());
    add(std::move(field));
  }

  // Positions are those of the first frame.
  void add(LearnedField field) {
    field.at = static_cast<std::ptrdiff_t>(at_ + offset_);
    if (field.text != 0) field.width = field.variable ? 0 : field.text;
    offset_ += field.width != 0 ? field.width : field.text;
    field.evidence = {rows_.size(), rows_.size()};
    fields_.push_back(std::move(field));
  }

  template <typename Size>
  void skip(const Size& size) {
    for (std::size_t row = 0; row < rows_.size(); ++row) begins_[row] += size(row);
  }

  const std::size_t at_;
  std::size_t offset_ = 0;
  Frames texts_;
  std::vector<std::vector<Token>> rows_;
  std::vector<std::size_t> begins_;
  std::vector<LearnedField> fields_;
};

}  // namespace

std::vector<LearnedField> text_values(const Frames& frames, std::size_t at, std::size_t end_size) {
  return TextValues(frames, at, end_size).run();
}

}  // namespace fieldcast::learn

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "tools/cli/inspect/learn/frame_fields.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;

bool is_sign(std::uint8_t c) { return c == '+' || c == '-'; }
bool is_number_character(std::uint8_t c) {
  return (c >= '0' && c <= '9') || c == '.' || is_sign(c);
}

// A text, which may be empty, and a number in turn. A sign begins a number, also directly behind a
// number.
Frames pieces_of(ByteView text) {
  Frames pieces;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const bool in_number = pieces.size() % 2 != 0;
    const bool number = i < text.size() && is_number_character(text[i]);
    const bool next = in_number && i > begin && number && is_sign(text[i]);
    if (i < text.size() && number == in_number && !next) continue;
    pieces.push_back(text.subspan(begin, i - begin));
    if (next) pieces.push_back(text.subspan(i, 0));
    begin = i;
  }
  return pieces;
}

std::size_t blanks_behind(ByteView text) {
  const auto last = std::find_if(text.rbegin(), text.rend(), [](auto c) { return c != ' '; });
  return static_cast<std::size_t>(last - text.rbegin());
}

bool same_size(const Frames& piece) { return shortest(piece) == longest(piece); }

// Fewer blanks before more digits: the number has a fixed width, to which they belong.
void align(Frames& text, Frames& number) {
  if (same_size(number)) return;
  std::size_t least = SIZE_MAX;
  const std::size_t width = blanks_behind(text[0]) + number[0].size();
  for (std::size_t row = 0; row < text.size(); ++row) {
    if (blanks_behind(text[row]) + number[row].size() != width) return;
    least = std::min(least, blanks_behind(text[row]));
  }
  for (std::size_t row = 0; row < text.size(); ++row) {
    const std::size_t moved = blanks_behind(text[row]) - least;
    text[row] = text[row].first(text[row].size() - moved);
    number[row] = ByteView(number[row].data() - moved, number[row].size() + moved);
  }
}

class TextValues {
 public:
  TextValues(const Frames& frames, std::size_t at, std::size_t end_size) {
    for (const ByteView frame : frames) {
      if (frame.size() < at + end_size) continue;
      if (begin_ == nullptr) begin_ = frame.data();
      const Frames row = pieces_of(frame.subspan(at, frame.size() - at - end_size));
      if (pieces_.empty()) pieces_.resize(row.size());
      common_ = common_ && row.size() == pieces_.size();
      for (std::size_t i = 0; common_ && i < row.size(); ++i) pieces_[i].push_back(row[i]);
    }
  }

  std::vector<LearnedField> run() {
    if (!common_) return {};
    for (std::size_t i = 1; i < pieces_.size(); i += 2) align(pieces_[i - 1], pieces_[i]);
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      i % 2 != 0 ? add_number(pieces_[i]) : add_text(pieces_[i]);
    // Only the constant behind a variable text shows its end.
    for (std::size_t i = 0; i + 1 < fields_.size(); ++i) {
      if (fields_[i].variable && fields_[i + 1].kind != FieldKind::kConstant) return {};
    }
    return std::move(fields_);
  }

 private:
  // A number that never changes is rather a code, such as that of OBIS.
  void add_number(const Frames& piece) {
    const bool constant = std::ranges::all_of(
        piece, [&](ByteView each) { return std::ranges::equal(each, piece.front()); });
    if (constant && piece.size() > 1) return add_constant(piece.front());
    add_value(piece.front(), fmt::format("decimal({})", longest(piece)), !same_size(piece));
  }

  // What all have at its beginning and end is constant, and something between them a value.
  void add_text(const Frames& piece) {
    const ByteView first = piece.front();
    const std::size_t least = shortest(piece), most = longest(piece);
    std::size_t head = 0, tail = 0;
    const auto agree = [&](std::ptrdiff_t at) {
      return std::ranges::all_of(
          piece, [&](ByteView each) { return byte_at(each, at) == byte_at(first, at); });
    };
    while (head < least && agree(static_cast<std::ptrdiff_t>(head))) ++head;
    while (head + tail < least && agree(-1 - static_cast<std::ptrdiff_t>(tail))) ++tail;
    if (least != most) {  // "kg" and "g" have no common end
      while (head > 0 && std::isalnum(first[head - 1]) != 0) --head;
      while (tail > 0 && std::isalnum(first[first.size() - tail]) != 0) --tail;
    }
    add_constant(first.first(head));
    const ByteView middle = first.subspan(head, first.size() - head - tail);
    if (most > head + tail) add_value(middle, std::to_string(most - head - tail), least != most);
    add_constant(first.last(tail));
  }

  void add_constant(ByteView bytes) {
    if (bytes.empty()) return;
    LearnedField made = constant_field(bytes, bytes.data() - begin_);
    const bool joins = !fields_.empty() && fields_.back().kind == FieldKind::kConstant &&
                       fields_.back().width + bytes.size() <= 64;
    if (!joins) return add(std::move(made));
    append(fields_.back().constant, bytes);
    fields_.back().width += bytes.size();
  }

  void add_value(ByteView first, const std::string& text, bool variable) {
    LearnedField made{.kind = FieldKind::kValue, .at = first.data() - begin_};
    made.width = variable ? 0 : first.size();
    made.variable = variable;
    // One character of a text is rather a code.
    if (variable || text != "1")
      made.options = fmt::format(", text: {}{}", text, variable ? ", variable: true" : "");
    add(std::move(made));
  }

  void add(LearnedField field) {
    field.evidence = {pieces_.front().size(), pieces_.front().size()};
    fields_.push_back(std::move(field));
  }

  const std::uint8_t* begin_ = nullptr;  // of the first frame
  bool common_ = true;
  std::vector<Frames> pieces_;  // by piece, then by frame
  std::vector<LearnedField> fields_;
};

}  // namespace

std::vector<LearnedField> text_values(const Frames& frames, std::size_t at, std::size_t end_size) {
  return TextValues(frames, at, end_size).run();
}

}  // namespace fieldcast::learn

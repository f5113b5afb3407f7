#include "config/yaml/yaml_scan.hpp"

#include <string_view>
#include <tuple>

namespace fieldcast::config {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool ends_word(char c) { return is_blank(c) || c == '\n' || c == '\0'; }
char closing_of(char open) { return open == '[' ? ']' : '}'; }

class Scanner {
 public:
  Scanner(const Source& source, const Position& stopped)
      : text_(source.text), stopped_(stopped), at_{&source, 0, 0} {}

  YamlScan run() {
    while (next_ < text_.size()) step();
    if (!taken_) scan_.open = stack_;
    scan_.never_closed = std::move(stack_);
    return std::move(scan_);
  }

  [[nodiscard]] bool at_quote() const { return peek() == '"' || peek() == '\''; }

  // REQUIRES: at_quote().
  Quote read_quote() {
    Quote quote{peek(), at_, at_, false};
    advance();
    while (next_ < text_.size()) {
      quote.end = at_;
      const char c = peek();
      // \" and ''.
      const bool escaped = quote.sign == '"' ? c == '\\' : c == '\'' && peek(1) == '\'';
      advance();
      if (escaped) {
        if (next_ < text_.size()) advance();
      } else if (c == quote.sign) {
        quote.closed = true;
        break;
      }
    }
    return quote;
  }

 private:
  [[nodiscard]] char peek(std::size_t ahead = 0) const {
    return next_ + ahead < text_.size() ? text_[next_ + ahead] : '\0';
  }

  void advance() {
    if (text_[next_++] == '\n')
      ++at_.line, at_.column = 0;
    else
      ++at_.column;
  }

  void take_stack() {
    if (taken_ || is_before(at_, stopped_)) return;
    scan_.open = stack_;
    taken_ = true;
  }

  void step() {
    take_stack();
    const char c = peek();
    if (c == '\n') {
      fresh_ = line_begins_ = true;
      behind_bracket_ = false;
      return advance();
    }
    if (is_blank(c)) return advance();
    const bool behind_blank = next_ == 0 || ends_word(text_[next_ - 1]);
    if (c == '#' && behind_blank) return skip_line();
    if (line_begins_ && !(c == '-' && ends_word(peek(1)))) {
      content_ = at_.column;
      line_begins_ = false;
    }
    if (fresh_ ? begin_value(c) : in_value(c)) advance();
  }

  void skip_line() {
    while (next_ < text_.size() && peek() != '\n') advance();
  }

  // Returns false if the text was already consumed.
  bool begin_value(char c) {
    if (at_quote()) {
      const bool earlier = is_before(at_, stopped_);
      Quote quote = read_quote();
      if (earlier) scan_.quote = quote;
      return fresh_ = false;
    }
    if ((c == '|' || c == '>') && stack_.empty()) return skip_block_text();
    if (c == '-' && ends_word(peek(1))) return true;
    if (c == '&' || c == '!' || c == '*') {  // an anchor, a tag: the value follows
      while (!ends_word(peek()) && peek() != ',') advance();
      return false;
    }
    if (c == '[' || c == '{') return open(c);
    fresh_ = c == ']' || c == '}' || (c == ',' && !stack_.empty());
    return in_value(c);
  }

  bool in_value(char c) {
    const char after = peek(1);
    if (c == ':' && (ends_word(after) || (!stack_.empty() && (after == ',' || after == '}'))))
      return fresh_ = true;
    // Brackets inside a text of a block are text.
    if (stack_.empty() && !fresh_ && !behind_bracket_) return true;
    if (c == ',') return fresh_ = true;
    if (c == '[' || c == '{') return open(c);
    if (c == ']' || c == '}') close(c);
    return true;
  }

  bool open(char c) {
    stack_.push_back({c, at_});
    return fresh_ = true;
  }

  void close(char c) {
    const bool fits = !stack_.empty() && closing_of(stack_.back().sign) == c;
    if (!fits && !scan_.mismatch) {
      scan_.mismatch = {stack_.empty() ? std::nullopt : std::optional(stack_.back()), {c, at_}};
    }
    if (!stack_.empty()) stack_.pop_back();
    fresh_ = false;
    behind_bracket_ = stack_.empty();
  }

  // The lines after '|' or '>' that are indented deeper than its key.
  bool skip_block_text() {
    const std::uint32_t key = content_;
    for (skip_line(); next_ < text_.size(); skip_line()) {
      std::size_t first = next_ + 1;
      while (first < text_.size() && text_[first] == ' ') ++first;
      const bool blank = first == text_.size() || text_[first] == '\n' || text_[first] == '\r';
      if (!blank && first - next_ - 1 <= key) break;
      advance();
    }
    return false;
  }

  std::string_view text_;
  const Position stopped_;
  Position at_;
  std::size_t next_ = 0;
  bool fresh_ = true;            // a value may begin
  bool line_begins_ = true;      // only blanks and "- " so far
  bool behind_bracket_ = false;  // the last bracket of the line closed all
  std::uint32_t content_ = 0;    // column of the line's first key or value
  std::vector<Bracket> stack_;
  bool taken_ = false;
  YamlScan scan_;
};

}  // namespace

bool is_before(const Position& a, const Position& b) {
  return std::tie(a.line, a.column) < std::tie(b.line, b.column);
}

YamlScan scan_yaml(const Source& source, const Position& stopped) {
  return Scanner(source, stopped).run();
}

}  // namespace fieldcast::config

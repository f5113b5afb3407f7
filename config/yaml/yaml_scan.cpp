#include "config/yaml/yaml_scan.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <tuple>

#include "config/document/limits.hpp"

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
    take_stack();
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

  void skip_to(const Position& position) {
    while (next_ < text_.size() && is_before(at_, position)) advance();
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

std::optional<Quote> quote_at(const Source& source, const Position& begin) {
  Scanner scanner(source, begin);
  scanner.skip_to(begin);
  return scanner.at_quote() ? std::optional(scanner.read_quote()) : std::nullopt;
}

namespace {

// Memory of yaml-cpp for a token with its values; measured with glibc.
constexpr std::size_t kBracketBytes = 230, kCommaBytes = 180, kColonBytes = 180,
                      kPropertyBytes = 100;

// Limit of the signs &, * and ! anywhere in the text, also in words and quotes.
constexpr std::size_t kMaxMarks = 5 * kMaxProperties;

class TokenCounter {
 public:
  // The limit that the text exceeds with its next character, or null.
  const char* feed(char c) {
    if (c == '\n') return end_line();
    count_raw(c);
    if (comment_) return exceeded();
    if (quote_ != 0) return inside_quote(c);
    if (c == '#' && blank(last_)) {
      comment_ = true;
    } else if ((c == '"' || c == '\'') && opens_quote()) {
      quote_ = c;
    } else if ((c == '&' || c == '*' || c == '!') && apart()) {
      ++properties_;
      held_ += kPropertyBytes;
    }
    count(c);
    last_ = c;
    if (!blank(c)) previous_ = c;
    return exceeded();
  }

 private:
  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\n'; }
  [[nodiscard]] bool apart() const {
    return blank(last_) || last_ == '[' || last_ == '{' || last_ == ',' || last_ == ':';
  }
  // A quote within a plain text does not open a quoted one.
  [[nodiscard]] bool opens_quote() const {
    return apart() && std::string_view("\n[{,:-?").find(previous_) != std::string_view::npos;
  }

  const char* end_line() {
    comment_ = false;
    last_ = previous_ = '\n';
    if (hold_ == 0) held_ = 0;  // a possible key ends with its line
    return ++lines_ > kMaxLines ? "lines" : nullptr;
  }

  const char* inside_quote(char c) {
    if (escaped_) {
      escaped_ = false;
    } else if (quote_ == '"' && c == '\\') {
      escaped_ = true;
    } else if (c == quote_) {
      quote_ = 0;
    }
    last_ = previous_ = c;
    return exceeded();
  }

  // Counts in all contexts, as the detection of quotes and comments is approximate.
  void count_raw(char c) {
    if (c == '[' || c == '{') ++brackets_;
    if (c == ',') ++commas_;
    if (c == '&' || c == '*' || c == '!') ++marks_;
  }

  void count(char c) {
    if (c == '[' || c == '{') {
      ++depth_;
      // A bracket after "key:" cannot become a key.
      if (hold_ == 0 && previous_ != ':') hold_ = depth_;
      if (hold_ != 0) held_ += kBracketBytes;
    } else if (c == ']' || c == '}') {
      if (depth_ > 0) --depth_;
      if (depth_ < hold_) hold_ = held_ = 0;
    } else if (c == ',') {
      if (hold_ != 0) held_ += kCommaBytes;
    } else if (c == ':' && hold_ != 0) {
      held_ += kColonBytes;
    }
  }

  [[nodiscard]] const char* exceeded() const {
    if (brackets_ > kMaxBrackets) return "of [ and {";
    if (commas_ > kMaxCommas) return "commas";
    if (properties_ > kMaxProperties || marks_ > kMaxMarks) return "of &, * and !";
    if (held_ > kMaxHeldBytes) return "held";
    return nullptr;
  }

  std::size_t brackets_ = 0, commas_ = 0, properties_ = 0, marks_ = 0, lines_ = 0, held_ = 0;
  std::size_t depth_ = 0;
  std::size_t hold_ = 0;  // depth of the bracket whose tokens are held; 0 if none
  char quote_ = 0, last_ = '\n', previous_ = '\n';
  bool comment_ = false, escaped_ = false;
};

std::string limit_text(std::string_view exceeded) {
  const std::string remedy = "; long channel lists belong in CSV files";
  if (exceeded == "held")
    return "some 900 000 values in one pair of brackets; maps and lists without brackets, or "
           "channel lists in CSV files";
  if (exceeded == "lines") return fmt::format("{} lines{}", kMaxLines, remedy);
  if (exceeded == "commas") return fmt::format("{} commas{}", kMaxCommas, remedy);
  const bool brackets = exceeded == "of [ and {";
  return fmt::format("{} {}{}", brackets ? kMaxBrackets : kMaxProperties, exceeded, remedy);
}

}  // namespace

bool check_tokens(const Source& source, FaultList& faults) {
  TokenCounter counter;
  Position position{&source, 0, 0};
  for (const char c : source.text) {
    if (const char* exceeded = counter.feed(c)) {
      faults.add(position, "the file holds too many values", limit_text(exceeded));
      return false;
    }
    ++position.column;
    if (c == '\n') ++position.line, position.column = 0;
  }
  return true;
}

}  // namespace fieldcast::config

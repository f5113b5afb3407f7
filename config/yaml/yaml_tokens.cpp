#include "config/yaml/yaml_tokens.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "config/document/limits.hpp"

namespace fieldcast::config {
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

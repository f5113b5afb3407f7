#include "config/yaml/yaml_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "config/yaml/yaml_scan.hpp"

namespace fieldcast::config {
namespace {

constexpr auto kNone = std::string_view::npos;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == kNone) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string in_quotes(std::string_view text) { return fmt::format("\"{}\"", trimmed(text)); }
std::string line_text(std::uint32_t line) { return fmt::format("line {}", line + 1); }
std::string spaces_text(std::size_t count) {
  return fmt::format("{}{}", count, count == 1 ? " space" : " spaces");
}

// One line of the text and its indentation: "  - name: bus  # first".
struct Line {
  std::string_view text;      // without comment
  std::size_t indent = 0;     // spaces before the first character
  std::size_t content = 0;    // column after a leading "- "
  bool item = false;          // begins with "- "
  std::size_t colon = kNone;  // of the first "key: ", or of "key:" at the end
  [[nodiscard]] bool blank() const { return indent == kNone; }
  [[nodiscard]] std::string_view key() const {
    return trimmed(text.substr(content, colon == kNone ? kNone : colon - content));
  }
  [[nodiscard]] bool has_value() const {
    return colon != kNone && !trimmed(text.substr(colon + 1)).empty();
  }
};

std::size_t find_colon(std::string_view text, std::size_t from) {
  for (auto at = text.find(':', from); at != kNone; at = text.find(':', at + 1)) {
    if (at + 1 == text.size() || text[at + 1] == ' ' || text[at + 1] == '\t') return at;
  }
  return kNone;
}

Line line_of(std::string_view text) {
  if (text.ends_with('\r')) text.remove_suffix(1);
  for (auto at = text.find('#'); at != kNone; at = text.find('#', at + 1)) {
    if (at > 0 && text[at - 1] != ' ' && text[at - 1] != '\t') continue;
    text = text.substr(0, at);
    break;
  }
  Line line{text, text.find_first_not_of(' '), 0, false, kNone};
  if (line.blank()) return line;
  line.content = line.indent;
  while (line.content < text.size() && text[line.content] == '-' &&
         (line.content + 1 == text.size() || text[line.content + 1] == ' ')) {
    line.item = true;
    line.content = std::min(text.find_first_not_of(' ', line.content + 1), text.size());
  }
  line.colon = find_colon(text, line.content);
  return line;
}

struct Case {
  const Source& source;
  Position stopped;
  YamlProblem problem;
  YamlScan scan;
  std::vector<Line> lines;  // up to where the parser stopped

  [[nodiscard]] const Line& line() const { return lines[stopped.line]; }
  // The last line above that is not blank.
  [[nodiscard]] const Line* above() const {
    for (auto n = stopped.line; n > 0; --n) {
      if (!lines[n - 1].blank()) return &lines[n - 1];
    }
    return nullptr;
  }
  [[nodiscard]] std::uint32_t number_of(const Line& line) const {
    return static_cast<std::uint32_t>(&line - lines.data());
  }
  [[nodiscard]] Position position(const Line& line, std::size_t column) const {
    return {&source, number_of(line), static_cast<std::uint32_t>(column)};
  }
  [[nodiscard]] bool says(std::string_view words) const {
    return problem.message.find(words) != kNone;
  }
  [[nodiscard]] bool reads(std::string_view words) const {
    return problem.reading.find(words) != kNone;
  }
  // The block structure is broken: a line or a text where no element may follow.
  [[nodiscard]] bool misplaced() const {
    return says("did not find expected key") || says("did not find expected '-' indicator");
  }
  [[nodiscard]] bool in_brackets() const { return reads("a flow"); }
  [[nodiscard]] bool misplaced_colon() const { return says("mapping values are not allowed"); }
  [[nodiscard]] bool at_line_start() const {
    return !line().blank() && stopped.column == line().indent;
  }
};

using Found = std::optional<YamlError>;

Found open_quote(const Case& c) {
  const auto& quote = c.scan.quote;
  if (!quote) return {};
  const bool over_lines = quote->begin.line != quote->end.line && quote->end.line == c.stopped.line;
  if (quote->closed && !over_lines) return {};
  const Line& line = c.lines[quote->begin.line];
  const auto rest =
      line.text.substr(std::min<std::size_t>(quote->begin.column + 1, line.text.size()));
  const auto meant = trimmed(rest.substr(0, rest.find_first_of(",}]")));
  const std::string sign(1, quote->sign);
  return YamlError{quote->begin, "the quote that opens here does not close on its line",
                   fmt::format("another {} at the end of the text", sign),
                   meant.empty() ? "" : fmt::format("{}{}{}", sign, meant, sign)};
}

Found tab(const Case& c) {
  const auto text = c.line().text;
  const auto first = text.find_first_not_of(' ');
  if (first == kNone || text[first] != '\t') return {};
  return YamlError{c.position(c.line(), first), "a tab in the indentation", "spaces"};
}

// To a comma or a bracket inside brackets, else to the end of the line.
std::string_view value_from(const Case& c, std::size_t at) {
  const auto rest = c.line().text.substr(std::min(at, c.line().text.size()));
  return trimmed(c.scan.open.empty() ? rest : rest.substr(0, rest.find_first_of(",]}")));
}

Found sign_that_begins_no_value(const Case& c) {
  const bool alias = c.reads("scanning an alias") || c.reads("scanning an anchor");
  const std::size_t at = alias ? c.problem.begin.column : c.stopped.column;
  if (at >= c.line().text.size()) return {};
  const bool comma = c.misplaced() && c.line().text[at] == ',';
  const bool dash = c.says("block sequence entries are not allowed") ||
                    (c.says("expected node content") && c.line().text[at] == '-');
  if (!alias && !dash && !comma && !c.says("cannot start any token")) return {};
  const std::string sign(1, c.line().text[at]);
  if (sign == "&")
    return YamlError{c.position(c.line(), at), "a name behind '&' that is not allowed",
                     "letters of a to z, digits, '-' and '_', or a text that begins so in quotes"};
  return YamlError{
      c.position(c.line(), at),
      dash ? "'-' begins an item of a list, which has a line of its own"
           : "a value cannot begin with " + (sign == "'" ? "\"'\"" : fmt::format("'{}'", sign)),
      "a text that begins so in quotes", in_quotes(value_from(c, at))};
}

Found bracket_closed_by_another(const Case& c) {
  const auto& mismatch = c.scan.mismatch;
  if (!mismatch || mismatch->closing.position.line > c.stopped.line) return {};
  const std::string closing(1, mismatch->closing.sign);
  if (!mismatch->open)
    return YamlError{mismatch->closing.position, fmt::format("'{}' closes nothing", closing), ""};
  const std::string open(1, mismatch->open->sign), own = open == "[" ? "]" : "}";
  return YamlError{mismatch->open->position,
                   fmt::format("this '{}' is not closed before the '{}' in {}", open, closing,
                               line_text(mismatch->closing.position.line)),
                   fmt::format("'{}' at the end of its values", own)};
}

Found bracket_never_closed(const Case& c) {
  const bool at_end = c.stopped.line + 1 >= c.lines.size() && c.line().blank();
  if (!c.in_brackets() && !c.misplaced_colon() && !at_end) return {};
  const auto never = [&](const Bracket& bracket) {
    return std::ranges::any_of(c.scan.never_closed, [&](const Bracket& other) {
      return !is_before(other.position, bracket.position) &&
             !is_before(bracket.position, other.position);
    });
  };
  for (auto bracket = c.scan.open.rbegin(); bracket != c.scan.open.rend(); ++bracket) {
    if (!never(*bracket)) continue;
    const char sign = bracket->sign;
    return YamlError{bracket->position, fmt::format("this '{}' is never closed", sign),
                     fmt::format("'{}' at the end of its values", sign == '[' ? ']' : '}')};
  }
  return {};
}

Found text_behind_quote(const Case& c) {
  const auto& quote = c.scan.quote;
  if (!quote || !quote->closed || quote->end.line != c.stopped.line ||
      quote->end.column >= c.stopped.column || !(c.misplaced() || c.in_brackets()))
    return {};
  const auto text = c.line().text;
  const auto between = quote->end.column + std::size_t{1};
  if (c.stopped.column > text.size() ||
      !trimmed(text.substr(between, c.stopped.column - between)).empty())
    return {};
  const bool apostrophe = quote->sign == '\'';
  return YamlError{c.stopped, "text behind the closing quote",
                   apostrophe ? "quotes around the whole text; '' is a quote inside of '...'"
                              : "quotes around the whole text; \\\" is a quote inside of \"...\""};
}

// A line among keys that is not "key: value".
Found no_key(const Case& c, const Line& line) {
  if (line.colon != kNone || line.blank()) return {};
  const auto colon = line.text.find(':', line.content);
  if (colon == kNone)
    return YamlError{c.position(line, line.content), fmt::format("'{}' has no ':'", line.key()),
                     "key: value"};
  return YamlError{c.position(line, colon), "no space behind the ':'", "key: value",
                   fmt::format("{}: {}", line.text.substr(line.content, colon - line.content),
                               trimmed(line.text.substr(colon + 1)))};
}

Found line_without_key(const Case& c) {
  if (!c.says("could not find expected ':'") || !c.scan.open.empty()) return {};
  return no_key(c, c.lines[c.problem.begin.line]);
}

// Either the value above is not "key: value", or the indentation of this line is wrong.
Found key_inside_the_value_above(const Case& c) {
  if (!c.misplaced_colon() || c.line().colon != c.stopped.column) return {};
  const Line* above = c.above();
  if (above == nullptr || !c.scan.open.empty()) return {};
  if (auto found = no_key(c, *above)) return found;
  if (!above->has_value() || c.line().content <= above->content) return {};
  // "name: a" and deeper "at: b": the first one may lack its "- ".
  std::string allowed = spaces_text(above->content) + " before it";
  if (!above->item && !c.line().item && c.line().content == above->content + 2)
    allowed = fmt::format("'- ' before '{}' in {}, or {}", above->key(),
                          line_text(c.number_of(*above)), allowed);
  return YamlError{
      c.position(c.line(), c.line().content),
      c.line().item
          ? fmt::format("an item of a list below '{}' in {}, which has a value already",
                        above->key(), line_text(c.number_of(*above)))
          : fmt::format("'{}' is indented deeper than '{}' in {}, which has a value already",
                        c.line().key(), above->key(), line_text(c.number_of(*above))),
      std::move(allowed)};
}

Found colon_inside_a_value(const Case& c) {
  const auto text = c.line().text;
  const std::size_t at = c.stopped.column;
  if (at >= text.size() || text[at] != ':') return {};
  if (!c.in_brackets() && !c.misplaced_colon() && !c.says("unexpected ':'")) return {};
  std::size_t begin = c.line().content;
  if (!c.scan.open.empty()) {
    const auto sign = text.substr(0, at).find_last_of(",[{");
    if (sign != kNone) begin = sign + 1;
  }
  const auto first = find_colon(text, begin);
  if (first == kNone || first >= at) return {};
  return YamlError{c.stopped, "a second ':' in a value", "a text with ': ' inside in quotes",
                   in_quotes(value_from(c, first + 1))};
}

struct Level {
  std::size_t column;
  bool list;
  const Line* line;
};

std::vector<Level> levels_above(const Case& c) {
  std::vector<Level> levels;
  const auto enter = [&](std::size_t column, bool list, const Line& line) {
    while (!levels.empty() && levels.back().column > column) levels.pop_back();
    const bool known = std::ranges::any_of(
        levels, [&](const Level& l) { return l.column == column && l.list == list; });
    if (!known) levels.push_back({column, list, &line});
  };
  for (std::uint32_t n = 0; n < c.stopped.line; ++n) {
    const Line& line = c.lines[n];
    if (line.blank()) continue;
    if (line.item) enter(line.indent, true, line);
    if (line.colon != kNone) enter(line.content, false, line);
  }
  return levels;
}

Found wrong_indentation(const Case& c) {
  if (!c.misplaced() || !c.at_line_start()) return {};
  const Line& line = c.line();
  const auto levels = levels_above(c);
  const Level* below = nullptr;  // the nearest levels with smaller and larger indentation
  const Level* deeper = nullptr;
  bool beside_list = false;
  bool lost_dash = false;  // the items of that list begin with this key
  for (const Level& level : levels) {
    if (level.list && level.column == line.indent) {
      beside_list = true;
      lost_dash = level.line->key() == line.key();
    }
    if (level.list != line.item) continue;
    if (level.column < line.indent) below = &level;
    if (level.column > line.indent && deeper == nullptr) deeper = &level;
  }
  std::string fitting;
  for (const Level* level : {deeper, below}) {
    if (level == nullptr) continue;
    fitting += fmt::format("{}{} as in {}", fitting.empty() ? "" : ", or ",
                           spaces_text(level->column), line_text(c.number_of(*level->line)));
  }
  if (!line.item && lost_dash) fitting = "'- ' before it, or " + fitting;
  const std::string name = line.item ? "this item" : fmt::format("'{}'", line.key());
  if (!line.item && beside_list)
    return YamlError{c.position(line, line.indent),
                     name + " stands under the '-' of a list, where only another '-' can stand",
                     fitting};
  if (fitting.empty())
    return YamlError{c.position(line, line.indent),
                     line.item ? "an item of a list among keys" : name + " among items of a list",
                     line.item ? "'- ' below a key without a value" : "'- '"};
  return YamlError{
      c.position(line, line.indent),
      fmt::format("{} is indented by {}, which fits nothing above", name, spaces_text(line.indent)),
      fitting};
}

Found wrong_escape(const Case& c) {
  if (!c.says("escape") && !c.says("expected hex")) return {};
  // The parser stops at the backslash or shortly behind it, possibly in the next line.
  for (auto n = c.stopped.line + 1; n > 0; --n) {
    const Line& line = c.lines[n - 1];
    const auto end = n - 1 == c.stopped.line ? c.stopped.column + std::size_t{1} : kNone;
    const auto at = line.text.substr(0, std::min(end, line.text.size())).rfind('\\');
    if (at == kNone) continue;
    const auto sign = line.text.substr(std::min(at + 1, line.text.size()), 1);
    const std::string_view digits = sign == "x"   ? "two"
                                    : sign == "u" ? "four"
                                    : sign == "U" ? "eight"
                                                  : "";
    if (!digits.empty() && c.says("expected hex"))
      return YamlError{c.position(line, at),
                       fmt::format("'\\{}' without {} hexadecimal digits behind it", sign, digits),
                       sign == "x"   ? "\\x02"
                       : sign == "u" ? "\\u0002"
                                     : "\\U00000002"};
    return YamlError{c.position(line, at),
                     fmt::format("'{}' means nothing in \"...\"", line.text.substr(at, 2)),
                     "\\\\ for a backslash, or '...', which has no such signs"};
  }
  return {};
}

struct Words {
  std::string_view parsers, ours, allowed;
};
constexpr std::array kWords{
    Words{"comment or line break", "text behind '|' or '>', which begin a text of several lines",
          "the text in quotes"},
    Words{"mapping keys are not allowed", "no key can stand here", "each key on a line of its own"},
    Words{"mapping values are not allowed", "a ':' where no key stands before it", "key: value"},
    Words{"could not find expected ':'", "a key without a ':' on its line", "key: value"},
    Words{"expected node content", "no value can stand here", "one value"},
    Words{"end of stream", "the text ends inside of a value", ""},
    Words{"directive", "a line that begins with '%'", "none; texts that begin so in quotes"},
    Words{"document", "a line that begins with '---' or '...'", "one document"},
    Words{"control characters", "a control character", "text in UTF-8"},
    Words{"tag", "a '!', which begins a tag", "no tags; texts that begin so in quotes"},
    Words{"unexpected ':'", "a ':' without a value behind it", "key: value, or the text in quotes"},
    Words{"',' or '}'", "neither ',' nor '}' behind a value", "{ key: value, .. }"},
    Words{"',' or ']'", "neither ',' nor ']' behind a value", "[ value, .. ]"},
    Words{"expected key", "no key can stand here", "key: value, indented like the keys above"},
    Words{"'-' indicator", "no item of a list can stand here", "'- ' below the others"},
};

YamlError in_words(const Case& c) {
  for (const Words& words : kWords) {
    if (c.says(words.parsers) || c.reads(words.parsers))
      return {c.stopped, std::string(words.ours), std::string(words.allowed), ""};
  }
  return {c.stopped, fmt::format("this is no YAML ({})", c.problem.message), "", ""};
}

std::vector<Line> lines_to(std::string_view text, std::uint32_t last) {
  std::vector<Line> lines;
  lines.reserve(last + 1);
  while (lines.size() <= last) {
    const auto end = text.find('\n');
    lines.push_back(line_of(text.substr(0, end)));
    text = end == kNone ? std::string_view{} : text.substr(end + 1);
  }
  return lines;
}

// The first matching function explains the case.
constexpr Found (*kMatchers[])(const Case&) = {open_quote,
                                               tab,
                                               sign_that_begins_no_value,
                                               bracket_closed_by_another,
                                               bracket_never_closed,
                                               text_behind_quote,
                                               line_without_key,
                                               key_inside_the_value_above,
                                               colon_inside_a_value,
                                               wrong_indentation,
                                               wrong_escape};

}  // namespace

YamlError explain_yaml_error(const Source& source, const YamlProblem& problem) {
  if (problem.message.find("<document start>") != kNone)
    return explain_second_document(source, problem.stopped);
  const Case c{source, problem.stopped, problem, scan_yaml(source, problem.stopped),
               lines_to(source.text, problem.stopped.line)};
  for (const auto matcher : kMatchers) {
    if (auto found = matcher(c)) return *std::move(found);
  }
  return in_words(c);
}

YamlError explain_second_document(const Source& source, const Position& position) {
  const auto lines = lines_to(source.text, position.line);
  const auto first = std::ranges::find_if_not(lines, &Line::blank);
  const Line& here = lines.back();
  const std::string one = "one document in a file, no '---' after the first";
  if (here.blank() || here.text.starts_with("---") || first->indent == 0)
    return {position, "a second document begins", one};
  return {position,
          fmt::format("'{}' is indented less than '{}', with which the file begins", here.key(),
                      first->key()),
          spaces_text(here.indent) + " before every key of the first level"};
}

}  // namespace fieldcast::config

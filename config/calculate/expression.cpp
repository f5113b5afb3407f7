#include "config/calculate/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "config/document/suggest.hpp"

namespace fieldcast::config {
namespace {

using OneArgument = double (*)(double);
using TwoArguments = double (*)(double, double);
using ThreeArguments = double (*)(double, double, double);
using ManyArguments = double (*)(const double*, int);

// A NaN among the values is the result, as in every other operation.
template <class Choice>
double chosen(const double* values, int count, Choice choice) {
  const double* const nan =
      std::find_if(values, values + count, [](double x) { return std::isnan(x); });
  return nan != values + count ? *nan : *choice(values, values + count);
}
double least(const double* values, int count) {
  return chosen(values, count, std::min_element<const double*>);
}
double most(const double* values, int count) {
  return chosen(values, count, std::max_element<const double*>);
}
double sum(const double* values, int count) { return std::accumulate(values, values + count, 0.0); }
double mean(const double* values, int count) { return sum(values, count) / count; }
double choose(double condition, double yes, double no) { return condition != 0 ? yes : no; }

constexpr std::array kOne{
    std::pair<const char*, OneArgument>{"abs", [](double x) { return std::abs(x); }},
    std::pair<const char*, OneArgument>{"acos", [](double x) { return std::acos(x); }},
    std::pair<const char*, OneArgument>{"asin", [](double x) { return std::asin(x); }},
    std::pair<const char*, OneArgument>{"atan", [](double x) { return std::atan(x); }},
    std::pair<const char*, OneArgument>{"ceil", [](double x) { return std::ceil(x); }},
    std::pair<const char*, OneArgument>{"cos", [](double x) { return std::cos(x); }},
    std::pair<const char*, OneArgument>{"exp", [](double x) { return std::exp(x); }},
    std::pair<const char*, OneArgument>{"floor", [](double x) { return std::floor(x); }},
    std::pair<const char*, OneArgument>{"ln", [](double x) { return std::log(x); }},
    std::pair<const char*, OneArgument>{"log10", [](double x) { return std::log10(x); }},
    std::pair<const char*, OneArgument>{"not", [](double x) { return x == 0 ? 1.0 : 0.0; }},
    std::pair<const char*, OneArgument>{"round", [](double x) { return std::round(x); }},
    std::pair<const char*, OneArgument>{"sin", [](double x) { return std::sin(x); }},
    std::pair<const char*, OneArgument>{"sqrt", [](double x) { return std::sqrt(x); }},
    std::pair<const char*, OneArgument>{"tan", [](double x) { return std::tan(x); }},
};
constexpr std::pair<const char*, TwoArguments> kAtan2{
    "atan2", [](double y, double x) { return std::atan2(y, x); }};
constexpr std::pair<const char*, ThreeArguments> kIf{"if", choose};
constexpr std::array kMany{
    std::pair<const char*, ManyArguments>{"max", most},
    std::pair<const char*, ManyArguments>{"mean", mean},
    std::pair<const char*, ManyArguments>{"min", least},
    std::pair<const char*, ManyArguments>{"sum", sum},
};

std::vector<std::string_view> functions() {
  std::vector<std::string_view> names{kAtan2.first, kIf.first};
  for (const auto& [name, function] : kOne) names.emplace_back(name);
  for (const auto& [name, function] : kMany) names.emplace_back(name);
  std::ranges::sort(names);
  return names;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

constexpr std::string_view kAllowed =
    "names of channels, numbers, + - * / ^, < <= > >= == !=, && ||, brackets, functions";

// Reads the text from left to right; the first fault ends it.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) { found_.code = text; }

  tl::expected<Expression, ExpressionFault> run() {
    while (!fault_ && at_ < text_.size()) next();
    if (!fault_ && text_.find_first_not_of(' ') == text_.npos)
      fail(0, "an empty expression", kAllowed);
    if (!fault_ && found_.names.empty())
      fail(0, "an expression without a channel", "at least one name of a channel");
    if (fault_) return tl::unexpected(std::move(*fault_));
    find_sums();
    return std::move(found_);
  }

 private:
  // What was read, for find_sums(): a name, or a character.
  struct Token {
    std::optional<std::size_t> name;
    char symbol = 0;
  };

  void next() {
    const char c = text_[at_];
    if (c == ' ') {
      ++at_;
    } else if (c == '{') {
      braces();
    } else if (is_letter(c)) {
      word();
    } else if (is_digit(c) || c == '.') {
      number();
    } else {
      symbol(c);
    }
  }

  void braces() {
    const std::size_t end = text_.find('}', at_);
    if (end == text_.npos) return fail(at_, "'{' without '}'", "{NAME OF A CHANNEL}");
    const std::string_view name = text_.substr(at_ + 1, end - at_ - 1);
    if (name.empty()) return fail(at_, "'{}' without a name", "{NAME OF A CHANNEL}");
    const auto index = use(name);
    if (!index) return;
    // Not longer than the braces, so that positions stay.
    found_.code.replace(at_, end + 1 - at_, variable(*index, end + 1 - at_));
    at_ = end + 1;
  }

  void word() {
    std::size_t end = at_;
    while (end < text_.size() && is_word(text_[end])) ++end;
    const std::string_view name = text_.substr(at_, end - at_);
    std::size_t behind = end;
    while (behind < text_.size() && text_[behind] == ' ') ++behind;
    const auto known = functions();
    const bool is_known = std::ranges::find(known, name) != known.end();
    if (behind < text_.size() && text_[behind] == '(') {
      if (!is_known)
        return fail(at_, fmt::format("unknown function '{}'", name), joined(known),
                    closest(name, known));
      // The parser of the library wants the bracket directly behind the name.
      found_.code.replace(at_, behind - at_, std::string(behind - end, ' ') + std::string(name));
      tokens_.push_back({{}, 'f'});
    } else if (is_known) {
      return fail(at_, fmt::format("function '{}' without brackets", name),
                  fmt::format("{}(...), or {{{}}} for a channel of this name", name, name));
    } else if (!use(name)) {
      return;
    }
    at_ = end;
  }

  // A name can follow a number only behind an operator.
  void number() {
    std::size_t end = at_;
    const auto digits = [&] {
      while (end < text_.size() && is_digit(text_[end])) ++end;
    };
    digits();
    if (end < text_.size() && text_[end] == '.') ++end;
    digits();
    if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'E')) {
      ++end;
      if (end < text_.size() && (text_[end] == '+' || text_[end] == '-')) ++end;
      digits();
    }
    if (end < text_.size() && (is_word(text_[end]) || text_[end] == '.'))
      return fail(at_, fmt::format("'{}' is not a number", text_.substr(at_, end + 1 - at_)),
                  "for example 0.5 or 1e3");
    tokens_.push_back({{}, '0'});
    at_ = end;
  }

  void symbol(char c) {
    const std::string_view two = text_.substr(at_, 2);
    if (two == "==" || two == "!=" || two == "<=" || two == ">=") return compare(two);
    if (two == "&&" || two == "||") {
      compared_.back() = false;
      tokens_.push_back({{}, '='});
      at_ += 2;
      return;
    }
    if (c == '=') return fail(at_, "'=' would be an assignment", "== to compare");
    if (c == '<' || c == '>') return compare(text_.substr(at_, 1));
    if (std::string_view("+-*/^(),").find(c) == std::string_view::npos)
      return fail(at_, fmt::format("character '{}'", shown(at_)), kAllowed);
    if (c == ',') compared_.back() = false;
    if (c == '(') compared_.push_back(false);
    if (c == ')' && compared_.size() > 1) compared_.pop_back();
    if (compared_.size() > kMaxBracketDepth + 1)
      return fail(at_, "too many nested brackets", fmt::format("{}", kMaxBracketDepth));
    tokens_.push_back({{}, c});
    ++at_;
  }

  // The parser would compare the result of the first comparison, 0 or 1: 10 < t < 80 is always 1.
  void compare(std::string_view symbol) {
    if (compared_.back())
      return fail(at_, "a comparison of a comparison", "a < b && b < c, or brackets");
    compared_.back() = true;
    tokens_.push_back({{}, '='});
    at_ += symbol.size();
  }

  // A whole character of UTF-8.
  [[nodiscard]] std::string_view shown(std::size_t at) const {
    std::size_t end = at + 1;
    while (end < text_.size() && (static_cast<unsigned char>(text_[end]) & 0xC0u) == 0x80u) ++end;
    return text_.substr(at, end - at);
  }

  std::optional<std::size_t> use(std::string_view name) {
    auto found = std::ranges::find(found_.names, name, &Expression::Name::text);
    if (found == found_.names.end() && found_.names.size() == kMaxInputs) {
      fail(at_, "too many channels in an expression", fmt::format("{}", kMaxInputs));
      return std::nullopt;
    }
    if (found == found_.names.end())
      found = found_.names.insert(found_.names.end(), {std::string(name), at_});
    const auto index = static_cast<std::size_t>(found - found_.names.begin());
    tokens_.push_back({index, 0});
    return index;
  }

  static std::string variable(std::size_t index, std::size_t width) {
    return fmt::format("{:<{}}", fmt::format("_{}", index), width);
  }

  // Names beside + or -, which no stronger operator takes.
  void find_sums() {
    const auto binds = [&](std::size_t at) {
      return at < tokens_.size() && !tokens_[at].name &&
             std::string_view("*/^").find(tokens_[at].symbol) != std::string_view::npos;
    };
    for (std::size_t i = 1; i + 1 < tokens_.size(); ++i) {
      const bool adds = tokens_[i].symbol == '+' || tokens_[i].symbol == '-';
      if (!adds || !tokens_[i - 1].name || !tokens_[i + 1].name) continue;
      if ((i >= 2 && binds(i - 2)) || binds(i + 2)) continue;
      found_.sums.emplace_back(*tokens_[i - 1].name, *tokens_[i + 1].name);
    }
  }

  void fail(std::size_t at, std::string what, std::string_view allowed,
            std::string suggestion = {}) {
    fault_ = {at, std::move(what), std::string(allowed), std::move(suggestion)};
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<bool> compared_{false};  // by bracket: the term that is read contains a comparison
  std::vector<Token> tokens_;
  Expression found_;
  std::optional<ExpressionFault> fault_;
};

// Owns a parser and the variables that it reads.
struct Compiled {
  mu::Parser parser;
  std::vector<double> values;
};

std::shared_ptr<Compiled> compiled(const Expression& expression) {
  auto made = std::make_shared<Compiled>();
  mu::Parser& parser = made->parser;
  parser.ClearFun();
  parser.ClearConst();
  for (const auto& [name, function] : kOne) parser.DefineFun(name, function);
  for (const auto& [name, function] : kMany) parser.DefineFun(name, function);
  parser.DefineFun(kAtan2.first, kAtan2.second);
  parser.DefineFun(kIf.first, kIf.second);
  made->values.resize(expression.names.size());
  for (std::size_t i = 0; i < expression.names.size(); ++i) {
    parser.DefineVar(fmt::format("_{}", i), &made->values[i]);
    const std::string& name = expression.names[i].text;
    if (is_letter(name.front()) && std::ranges::all_of(name, is_word))
      parser.DefineVar(name, &made->values[i]);
  }
  parser.SetExpr(expression.code);
  return made;
}

std::string text_of(const mu::ParserError& error) {
  switch (error.GetCode()) {
    case mu::ecUNEXPECTED_EOF: return "the expression ends too early";
    case mu::ecMISSING_PARENS: return "')' is missing";
    case mu::ecUNEXPECTED_PARENS: return "a bracket is not expected here";
    case mu::ecTOO_MANY_PARAMS: return "too many arguments of a function";
    case mu::ecTOO_FEW_PARAMS: return "too few arguments of a function";
    case mu::ecUNEXPECTED_OPERATOR: return "an operator is not expected here";
    case mu::ecUNEXPECTED_ARG_SEP: return "',' is not expected here";
    default: return "an operator or a bracket is missing";
  }
}

// What is allowed at the place of the fault; empty if the fault says it.
std::string remedy_of(const mu::ParserError& error) {
  switch (error.GetCode()) {
    case mu::ecTOO_MANY_PARAMS:
    case mu::ecTOO_FEW_PARAMS:
      return "if(condition, then, else), atan2(y, x), at least one argument of max, mean, min and "
             "sum, one of every other function";
    case mu::ecUNEXPECTED_OPERATOR: return "a number, the name of a channel, '(' or a function";
    default: return {};
  }
}

}  // namespace

tl::expected<Expression, ExpressionFault> parse_expression(std::string_view text) {
  return Scanner(text).run();
}

std::string as_written(std::string_view name) {
  const auto known = functions();
  const bool plain = !name.empty() && is_letter(name.front()) &&
                     std::ranges::all_of(name, is_word) &&
                     std::ranges::find(known, name) == known.end();
  return plain ? std::string(name) : fmt::format("{{{}}}", name);
}

tl::expected<Formula, ExpressionFault> compile(const Expression& expression) {
  const std::shared_ptr<Compiled> made = compiled(expression);
  try {
    (void)made->parser.Eval();
    if (made->parser.GetNumResults() != 1)
      return tl::unexpected(ExpressionFault{0, "',' outside of a function", "one expression"});
  } catch (const mu::ParserError& error) {
    const std::size_t at = error.GetPos() < 0 ? 0 : static_cast<std::size_t>(error.GetPos());
    return tl::unexpected(ExpressionFault{
        std::min(at, expression.code.size()), text_of(error), remedy_of(error), {}});
  }
  return [made](std::span<const double> values) {
    std::ranges::copy(values, made->values.begin());
    try {
      return made->parser.Eval();
    } catch (const mu::ParserError&) { return std::numeric_limits<double>::quiet_NaN(); }
  };
}

std::string function_names() { return joined(functions()); }

}  // namespace fieldcast::config

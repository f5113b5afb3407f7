#include "tools/import/formats/wb_condition.hpp"

#include <cctype>
#include <charconv>
#include <string>

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxConditionDepth = 50;

// or := and {"||" and}; and := comparison {"&&" comparison}; comparison := value [op value]
class ConditionParser {
 public:
  ConditionParser(std::string_view text, const ParameterValue& value_of)
      : text_(text), value_of_(value_of) {}

  std::optional<bool> parse() {
    const Value value = parse_or(0);
    skip_blanks();
    if (broken_ || at_ != text_.size()) return std::nullopt;
    return value.has_value() && *value != 0;
  }

 private:
  using Value = std::optional<double>;  // empty: an unset parameter

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n'))
      ++at_;
  }
  bool take(std::string_view word) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  Value fail() {
    broken_ = true;
    return std::nullopt;
  }

  Value parse_or(unsigned depth) {
    if (depth > kMaxConditionDepth) return fail();
    Value left = parse_and(depth);
    while (!broken_ && take("||")) {
      const Value right = parse_and(depth);
      left = left && right ? Value(*left != 0 || *right != 0) : Value(0);
    }
    return left;
  }

  Value parse_and(unsigned depth) {
    Value left = parse_comparison(depth);
    while (!broken_ && take("&&")) {
      const Value right = parse_comparison(depth);
      left = left && right ? Value(*left != 0 && *right != 0) : Value(0);
    }
    return left;
  }

  Value parse_comparison(unsigned depth) {
    const Value left = parse_value(depth);
    if (broken_) return left;
    for (const std::string_view op : {"==", "!=", ">=", "<=", ">", "<"}) {
      if (!take(op)) continue;
      const Value right = parse_value(depth);
      if (!left || !right) return Value(op == "!=" ? 1 : 0);
      return Value(compare(*left, op, *right) ? 1 : 0);
    }
    return left;
  }

  static bool compare(double left, std::string_view op, double right) {
    if (op == "==") return left == right;
    if (op == "!=") return left != right;
    if (op == ">=") return left >= right;
    if (op == "<=") return left <= right;
    return op == ">" ? left > right : left < right;
  }

  std::string_view identifier() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_'))
      ++at_;
    return text_.substr(begin, at_ - begin);
  }

  Value parse_value(unsigned depth) {
    if (take("(")) {
      const Value value = parse_or(depth + 1);
      return take(")") ? value : fail();
    }
    skip_blanks();
    double number = 0;
    const auto [end, fault] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), number);
    if (fault == std::errc{}) {
      at_ = static_cast<std::size_t>(end - text_.data());
      return number;
    }
    const std::string_view name = identifier();
    if (name.empty()) return fail();
    if (name != "isDefined") return value_of_(name);
    if (!take("(")) return fail();
    const bool defined = value_of_(identifier()).has_value();
    return take(")") ? Value(defined ? 1 : 0) : fail();
  }

  std::string_view text_;
  const ParameterValue& value_of_;
  std::size_t at_ = 0;
  bool broken_ = false;
};

}  // namespace

std::optional<bool> condition_holds(std::string_view condition, const ParameterValue& value_of) {
  return condition.size() > 10'000 ? std::nullopt : ConditionParser(condition, value_of).parse();
}

}  // namespace fieldcast::importing

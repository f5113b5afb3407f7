#include "tools/import/formats/expression.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <functional>

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxSumDepth = 20, kMaxConditionDepth = 50;

class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  bool take(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  void skip(std::string_view characters) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(characters), rest_.size()));
  }
  std::optional<double> number() {
    double value = 0;
    const auto [end, fault] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (fault != std::errc{}) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  std::string_view identifier() {
    const auto end = std::ranges::find_if_not(
        rest_, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
    const std::string_view name = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(name.size());
    return name;
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

// scale * X + offset; a constant has the scale 0.
struct Linear {
  double scale = 0, offset = 0;
};

class LinearParser {
 public:
  explicit LinearParser(std::string_view text) : scanner_(text) {}

  std::optional<LinearForm> parse() {
    const auto sum = parse_sum(0);
    if (!sum || !scanner_.at_end() || !seen_ || sum->scale == 0) return std::nullopt;
    form_.scale = sum->scale;
    form_.offset = sum->offset;
    return form_;
  }

 private:
  using Value = std::optional<Linear>;

  Value parse_sum(unsigned depth) {
    Value left = depth > kMaxSumDepth ? std::nullopt : parse_product(depth);
    while (left) {
      const bool plus = scanner_.take("+");
      if (!plus && !scanner_.take("-")) break;
      const Value right = parse_product(depth);
      if (!right) return std::nullopt;
      const double sign = plus ? 1 : -1;
      left = Linear{left->scale + sign * right->scale, left->offset + sign * right->offset};
    }
    return left;
  }

  Value parse_product(unsigned depth) {
    Value left = parse_factor(depth);
    while (left) {
      const bool times = scanner_.take("*");
      if (!times && !scanner_.take("/")) break;
      const Value right = parse_factor(depth);
      if (!right) return std::nullopt;
      if (times && left->scale == 0) {
        left = Linear{right->scale * left->offset, right->offset * left->offset};
      } else if (right->scale != 0 || (!times && right->offset == 0)) {
        return std::nullopt;  // a square, or a division by the value
      } else {
        const double by = times ? right->offset : 1 / right->offset;
        left = Linear{left->scale * by, left->offset * by};
      }
    }
    return left;
  }

  Value parse_factor(unsigned depth) {
    if (scanner_.take("-")) {
      Value value = depth > kMaxSumDepth ? std::nullopt : parse_factor(depth + 1);
      if (value) value = Linear{-value->scale, -value->offset};
      return value;
    }
    if (scanner_.take("(")) {
      const Value value = parse_sum(depth + 1);
      return value && scanner_.take(")") ? value : std::nullopt;
    }
    for (const std::string_view function : {"int32bs", "int32", "uint32bs", "uint32", "flt32bs",
                                            "flt32", "int16bs", "int16", "uint16bs"}) {
      if (!scanner_.take(function)) continue;
      if (scanner_.take("(R0,R1)") || scanner_.take("(R0)")) return the_value(function, false);
      return scanner_.take("(R1,R0)") ? the_value(function, true) : std::nullopt;
    }
    if (scanner_.take("R0")) return the_value({}, false);
    const auto number = scanner_.number();
    return number ? Value(Linear{0, *number}) : std::nullopt;
  }

  // The expression may use only one value, but several times.
  Value the_value(std::string_view function, bool low_first) {
    if (seen_ && (form_.function != function || form_.low_first != low_first)) return std::nullopt;
    seen_ = true;
    form_.function = function;
    form_.low_first = low_first;
    return Linear{1, 0};
  }

  Scanner scanner_;
  bool seen_ = false;
  LinearForm form_;
};

// or := and {"||" and}; and := comparison {"&&" comparison}; comparison := value [op value]
class ConditionParser {
 public:
  ConditionParser(std::string_view text, const ParameterValue& value_of)
      : scanner_(text), value_of_(value_of) {}

  std::optional<bool> parse() {
    const Value value = parse_or(0);
    skip_blanks();
    if (broken_ || !scanner_.at_end()) return std::nullopt;
    return value && *value != 0;
  }

 private:
  using Value = std::optional<double>;  // empty: an unset parameter

  void skip_blanks() { scanner_.skip(" \t\n"); }
  bool take(std::string_view word) {
    skip_blanks();
    return scanner_.take(word);
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
      left = left && right && (*left != 0 || *right != 0) ? 1 : 0;
    }
    return left;
  }

  Value parse_and(unsigned depth) {
    Value left = parse_comparison(depth);
    while (!broken_ && take("&&")) {
      const Value right = parse_comparison(depth);
      left = left && right && *left != 0 && *right != 0 ? 1 : 0;
    }
    return left;
  }

  Value parse_comparison(unsigned depth) {
    using Compare = bool (*)(double, double);
    constexpr std::pair<std::string_view, Compare> kOperators[] = {
        {"==", [](double a, double b) { return a == b; }},
        {"!=", [](double a, double b) { return a != b; }},
        {">=", [](double a, double b) { return a >= b; }},
        {"<=", [](double a, double b) { return a <= b; }},
        {">", [](double a, double b) { return a > b; }},
        {"<", [](double a, double b) { return a < b; }}};
    const Value left = parse_value(depth);
    if (broken_) return left;
    for (const auto& [op, holds] : kOperators) {
      if (!take(op)) continue;
      const Value right = parse_value(depth);
      return (left && right ? holds(*left, *right) : op == "!=") ? 1 : 0;
    }
    return left;
  }

  Value parse_value(unsigned depth) {
    if (take("(")) {
      const Value value = parse_or(depth + 1);
      return take(")") ? value : fail();
    }
    skip_blanks();
    if (const auto number = scanner_.number()) return number;
    const std::string_view name = scanner_.identifier();
    if (name.empty()) return fail();
    if (name != "isDefined") return value_of_(name);
    if (!take("(")) return fail();
    skip_blanks();
    const bool defined = value_of_(scanner_.identifier()).has_value();
    return take(")") ? Value(defined ? 1 : 0) : fail();
  }

  Scanner scanner_;
  const ParameterValue& value_of_;
  bool broken_ = false;
};

}  // namespace

std::optional<LinearForm> linear_form(std::string_view expression) {
  if (expression.size() > 500) return std::nullopt;
  std::string text(expression);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  return LinearParser(text).parse();
}

std::optional<bool> condition_holds(std::string_view condition, const ParameterValue& value_of) {
  return condition.size() > 10'000 ? std::nullopt : ConditionParser(condition, value_of).parse();
}

}  // namespace fieldcast::importing

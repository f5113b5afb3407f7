#include "tools/import/formats/expression.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxDepth = 50;

class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  bool take(std::string_view word) {
    skip_blanks();
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  std::optional<double> number() {
    skip_blanks();
    double value = 0;
    const auto [end, fault] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (fault != std::errc{}) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  std::string_view identifier() {
    skip_blanks();
    const auto end = std::ranges::find_if_not(
        rest_, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
    const std::string_view name = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(name.size());
    return name;
  }
  bool at_end() {
    skip_blanks();
    return rest_.empty();
  }

 private:
  void skip_blanks() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\n"), rest_.size()));
  }
  std::string_view rest_;
};

// scale * X + offset; a constant has the scale 0.
struct Linear {
  double scale = 0, offset = 0;
};
using Operand = std::optional<Linear>;  // empty: an unset parameter

constexpr Linear truth(bool holds) { return {0, holds ? 1.0 : 0.0}; }

Operand product(const Linear& a, const Linear& b) {
  if (a.scale != 0 && b.scale != 0) return std::nullopt;
  const auto& [value, by] = a.scale == 0 ? std::pair(b, a.offset) : std::pair(a, b.offset);
  return Linear{value.scale * by, value.offset * by};
}

enum Level : unsigned { kOr, kAnd, kComparison, kSum, kProduct };

// `apply` returns empty if the result is not linear.
struct Operator {
  Level level;
  std::string_view sign;
  Operand (*apply)(const Linear& a, const Linear& b);
};
using L = const Linear&;
constexpr Operator kOperators[] = {
    {kOr, "||", [](L a, L b) -> Operand { return truth(a.offset != 0 || b.offset != 0); }},
    {kAnd, "&&", [](L a, L b) -> Operand { return truth(a.offset != 0 && b.offset != 0); }},
    {kComparison, "==", [](L a, L b) -> Operand { return truth(a.offset == b.offset); }},
    {kComparison, "!=", [](L a, L b) -> Operand { return truth(a.offset != b.offset); }},
    {kComparison, ">=", [](L a, L b) -> Operand { return truth(a.offset >= b.offset); }},
    {kComparison, "<=", [](L a, L b) -> Operand { return truth(a.offset <= b.offset); }},
    {kComparison, ">", [](L a, L b) -> Operand { return truth(a.offset > b.offset); }},
    {kComparison, "<", [](L a, L b) -> Operand { return truth(a.offset < b.offset); }},
    {kSum, "+",
     [](L a, L b) -> Operand {
       return {{a.scale + b.scale, a.offset + b.offset}};
     }},
    {kSum, "-",
     [](L a, L b) -> Operand {
       return {{a.scale - b.scale, a.offset - b.offset}};
     }},
    {kProduct, "*", product},
    {kProduct, "/", [](L a, L b) -> Operand {
       if (b.scale != 0 || b.offset == 0) return std::nullopt;
       return product(a, {0, 1 / b.offset});
     }}};

class ExpressionParser {
 public:
  using Primary = std::function<bool(Scanner&, Operand&)>;

  ExpressionParser(std::string_view text, Level first, Level last, Primary primary)
      : scanner_(text), first_(first), last_(last), primary_(std::move(primary)) {}

  // Returns false if the text is not an expression with the operators of the levels.
  bool parse(Operand& value) { return parse_level(first_, 0, value) && scanner_.at_end(); }

 private:
  bool parse_level(unsigned level, unsigned depth, Operand& left) {
    if (level > last_) return parse_factor(depth, left);
    if (!parse_level(level + 1, depth, left)) return false;
    while (const Operator* op = take_operator(level)) {
      Operand right;
      if (!parse_level(level + 1, depth, right)) return false;
      const bool both = left && right;
      left = both ? op->apply(*left, *right) : truth(op->sign == "!=");
      if (!left) return false;
      if (level == kComparison) break;
    }
    return true;
  }

  bool parse_factor(unsigned depth, Operand& value) {
    if (depth > kMaxDepth) return false;
    if (scanner_.take("(")) return parse_level(first_, depth + 1, value) && scanner_.take(")");
    if (last_ != kProduct || !scanner_.take("-")) return primary_(scanner_, value);
    if (!parse_factor(depth + 1, value)) return false;
    value = Linear{-value->scale, -value->offset};
    return true;
  }

  const Operator* take_operator(unsigned level) {
    const auto* found = std::ranges::find_if(kOperators, [&](const Operator& op) {
      return op.level == level && scanner_.take(op.sign);
    });
    return found == std::end(kOperators) ? nullptr : found;
  }

  Scanner scanner_;
  const Level first_, last_;
  const Primary primary_;
};

}  // namespace

std::optional<LinearForm> linear_form(std::string_view expression) {
  if (expression.size() > 500) return std::nullopt;
  std::string text(expression);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  LinearForm form;
  bool seen = false;
  // The expression may use only one value, but several times.
  const auto use = [&](std::string_view function, bool low_first, Operand& value) {
    if (seen && (form.function != function || form.low_first != low_first)) return false;
    seen = true;
    form.function = function;
    form.low_first = low_first;
    value = Linear{1, 0};
    return true;
  };
  Operand sum;
  const auto primary = [&](Scanner& scanner, Operand& value) {
    for (const std::string_view function : {"int32bs", "int32", "uint32bs", "uint32", "flt32bs",
                                            "flt32", "int16bs", "int16", "uint16bs"}) {
      if (!scanner.take(function)) continue;
      if (scanner.take("(R0,R1)") || scanner.take("(R0)")) return use(function, false, value);
      return scanner.take("(R1,R0)") && use(function, true, value);
    }
    if (scanner.take("R0")) return use({}, false, value);
    const auto number = scanner.number();
    if (number) value = Linear{0, *number};
    return number.has_value();
  };
  const bool whole = ExpressionParser(text, kSum, kProduct, primary).parse(sum);
  if (!whole || !seen || sum->scale == 0) return std::nullopt;
  form.scale = sum->scale;
  form.offset = sum->offset;
  return form;
}

std::optional<bool> condition_holds(std::string_view condition, const ParameterValue& value_of) {
  if (condition.size() > 10'000) return std::nullopt;
  const auto primary = [&](Scanner& scanner, Operand& value) {
    auto number = scanner.number();
    if (number) return value = Linear{0, *number}, true;
    std::string_view name = scanner.identifier();
    if (name == "isDefined") {
      if (!scanner.take("(")) return false;
      value = truth(value_of(scanner.identifier()).has_value());
      return scanner.take(")");
    }
    if ((number = name.empty() ? number : value_of(name))) value = Linear{0, *number};
    return !name.empty();
  };
  Operand value;
  if (!ExpressionParser(condition, kOr, kComparison, primary).parse(value)) return std::nullopt;
  return value && value->offset != 0;
}

}  // namespace fieldcast::importing

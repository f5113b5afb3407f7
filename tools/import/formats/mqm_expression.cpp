// Expressions that are linear in one value: R0 / 10, (R0 - 320) * 0.05, int32(R1, R0) / 1000.
#include <array>
#include <charconv>

#include "tools/import/formats/mqm_converter.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxDepth = 20;
constexpr std::array<std::string_view, 9> kFunctions{
    "int32bs", "int32", "uint32bs", "uint32", "flt32bs", "flt32", "int16bs", "int16", "uint16bs"};

// scale * X + offset; a constant has the scale 0.
struct Linear {
  double scale = 0, offset = 0;
};

class ExpressionParser {
 public:
  explicit ExpressionParser(std::string_view text) {
    for (const char c : text) {
      if (c != ' ' && c != '\t') text_ += c;
    }
  }

  std::optional<LinearForm> parse() {
    const auto sum = parse_sum(0);
    if (!sum || at_ != text_.size() || !seen_ || sum->scale == 0) return std::nullopt;
    form_.scale = sum->scale;
    form_.offset = sum->offset;
    return form_;
  }

 private:
  using Value = std::optional<Linear>;

  bool take(std::string_view word) {
    if (!std::string_view(text_).substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }

  Value parse_sum(unsigned depth) {
    Value left = depth > kMaxDepth ? std::nullopt : parse_product(depth);
    while (left) {
      const bool plus = take("+");
      if (!plus && !take("-")) break;
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
      const bool times = take("*");
      if (!times && !take("/")) break;
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
    if (take("-")) {
      Value value = depth > kMaxDepth ? std::nullopt : parse_factor(depth + 1);
      if (value) value = Linear{-value->scale, -value->offset};
      return value;
    }
    if (take("(")) {
      const Value value = parse_sum(depth + 1);
      return value && take(")") ? value : std::nullopt;
    }
    for (const std::string_view function : kFunctions) {
      if (!take(function)) continue;
      if (take("(R0,R1)") || take("(R0)")) return the_value(std::string(function), false);
      if (take("(R1,R0)")) return the_value(std::string(function), true);
      return std::nullopt;
    }
    if (take("R0")) return the_value({}, false);
    return number();
  }

  // The expression may use only one value, but several times.
  Value the_value(std::string function, bool low_first) {
    if (seen_ && (form_.function != function || form_.low_first != low_first)) return std::nullopt;
    seen_ = true;
    form_.function = std::move(function);
    form_.low_first = low_first;
    return Linear{1, 0};
  }

  Value number() {
    double value = 0;
    const char* const begin = text_.data() + at_;
    const auto [end, fault] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (fault != std::errc{}) return std::nullopt;
    at_ += static_cast<std::size_t>(end - begin);
    return Linear{0, value};
  }

  std::string text_;
  std::size_t at_ = 0;
  bool seen_ = false;
  LinearForm form_;
};

}  // namespace

std::optional<LinearForm> linear_form(std::string_view expression) {
  return expression.size() > 500 ? std::nullopt : ExpressionParser(expression).parse();
}

}  // namespace fieldcast::importing

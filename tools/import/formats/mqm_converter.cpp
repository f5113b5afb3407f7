// Source: BlackZork/mqmgateway README.md, Data conversion, and stdconv/*.hpp: divide and multiply
// treat two registers as signed, and bits count from 1.
#include "tools/import/formats/mqm_converter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

namespace {

using Result = tl::expected<Converted, std::string>;

struct Arguments {
  std::vector<std::string> positional;
  std::vector<std::pair<std::string, std::string>> named;

  [[nodiscard]] std::string get(std::string_view name, std::size_t index) const {
    const auto found = std::ranges::find(named, name, [](const auto& pair) { return pair.first; });
    if (found != named.end()) return found->second;
    return index < positional.size() ? positional[index] : std::string();
  }
  [[nodiscard]] bool flag(std::string_view name, std::size_t index) const {
    const std::string word = lower(get(name, index));
    return word == "true" || word == "1" || word == name;
  }
};

std::string without_quotes(std::string_view text) {
  text = trimmed(text);
  const bool quoted =
      text.size() > 1 && (text[0] == '"' || text[0] == '\'') && text.back() == text[0];
  return std::string(quoted ? text.substr(1, text.size() - 2) : text);
}

// Commas inside quotes and brackets do not separate arguments.
Arguments arguments_of(std::string_view text) {
  Arguments arguments;
  std::string part;
  char quote = '\0';
  int depth = 0;
  const auto end_part = [&] {
    const std::size_t equals = part.find('=');
    const std::string_view key = equals == std::string::npos
                                     ? std::string_view()
                                     : trimmed(std::string_view(part).substr(0, equals));
    const bool named = !key.empty() && key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") ==
                                           std::string_view::npos;
    if (named) {
      arguments.named.emplace_back(key, without_quotes(std::string_view(part).substr(equals + 1)));
    } else if (!trimmed(part).empty()) {
      arguments.positional.push_back(without_quotes(part));
    }
    part.clear();
  };
  for (const char c : text) {
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '{') {
      ++depth;
    } else if (c == ')' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      end_part();
      continue;
    }
    part += c;
  }
  end_part();
  return arguments;
}

void set_orders(Converted& result, bool low_first, bool swap_bytes) {
  if (low_first) result.word_order = WordOrder::kLittleEndian;
  if (swap_bytes) result.byte_order = ByteOrder::kLittleEndian;
}

// divide, multiply: of one or two registers.
Result scaled(const Arguments& arguments, unsigned count, bool divide) {
  const auto number = number_from(arguments.get(divide ? "divisor" : "multipler", 0));
  if (!number || *number == 0) return tl::unexpected(std::string("a scale that is no number"));
  if (count > 2) return tl::unexpected(fmt::format("a scale of {} registers", count));
  Converted result;
  result.type = count == 2 ? ValueType::kInt32 : ValueType::kUint16;
  result.scale = divide ? 1 / *number : *number;
  set_orders(result, arguments.flag("low_first", 2), arguments.flag("swap_bytes", 3));
  return result;
}

Result plain(ValueType type, unsigned needed, unsigned count) {
  if (count != needed)
    return tl::unexpected(fmt::format("{} of {} registers", to_text(type), count));
  return Converted{.type = type};
}

Result expression(const Arguments& arguments, unsigned count) {
  const std::string text = arguments.get("expression", 0);
  const auto form = linear_form(text);
  if (!form)
    return tl::unexpected(fmt::format("the expression {} is not linear in one value", text));
  Converted result;
  std::string function = form->function;
  const bool swapped = function.ends_with("bs");
  if (swapped) function.resize(function.size() - 2);
  if (function == "int32") result.type = ValueType::kInt32;
  if (function == "uint32") result.type = ValueType::kUint32;
  if (function == "flt32") result.type = ValueType::kFloat32;
  if (function == "int16") result.type = ValueType::kInt16;
  const bool wide = function.ends_with("32");
  if (wide && count < 2) return tl::unexpected(fmt::format("{} of one register", function));
  set_orders(result, form->low_first, swapped);
  result.scale = form->scale;
  result.offset = form->offset;
  return result;
}

Result standard(std::string_view name, const Arguments& arguments, unsigned count) {
  if (name == "divide" || name == "multiply") return scaled(arguments, count, name == "divide");
  if (name == "int8" || name == "uint8") {
    auto result = plain(name == "int8" ? ValueType::kInt8 : ValueType::kUint8, 1, count);
    if (result) result->byte = arguments.flag("first", 0) ? 1 : 0;
    return result;
  }
  if (name == "int16" || name == "uint16") {
    auto result = plain(name == "int16" ? ValueType::kInt16 : ValueType::kUint16, 1, count);
    if (result) set_orders(*result, false, arguments.flag("swap_bytes", 0));
    return result;
  }
  if (name == "int32" || name == "uint32" || name == "float32" || name == "float") {
    const ValueType type = name == "int32"    ? ValueType::kInt32
                           : name == "uint32" ? ValueType::kUint32
                                              : ValueType::kFloat32;
    auto result = plain(type, 2, count);
    const std::size_t first = type == ValueType::kFloat32 ? 1 : 0;  // after the precision
    if (result)
      set_orders(*result, arguments.flag("low_first", first),
                 arguments.flag("swap_bytes", first + 1));
    return result;
  }
  if (name == "bit") {
    const auto number = whole_from(arguments.get("bit", 0));
    if (!number || *number < 1 || *number > 16)
      return tl::unexpected(std::string("a bit that is not 1 to 16"));
    Converted result{.type = ValueType::kBool, .bit = static_cast<std::uint8_t>(*number - 1)};
    result.change = "true and false instead of 1 and 0";
    return result;
  }
  if (name == "bitmask") {
    if (whole_from(arguments.get("mask", 0)) == 0xFFFFu || arguments.get("mask", 0).empty())
      return Converted{};
    return tl::unexpected(std::string("some bits of a register; a channel has one bit or all"));
  }
  if (name == "string") {
    if (2 * count > kMaxStringBytes)
      return tl::unexpected(fmt::format("a text of {} registers", count));
    return Converted{.type = ValueType::kString,
                     .string_bytes = static_cast<std::uint16_t>(2 * count)};
  }
  if (name == "map") {
    if (count != 1) return tl::unexpected(std::string("a map of several registers"));
    Converted result;
    result.change = "the number of the register, not the text that it is mapped to";
    return result;
  }
  return tl::unexpected(fmt::format("the converter std.{} has no counterpart", name));
}

}  // namespace

tl::expected<Converted, std::string> convert_mqm(std::string_view converter, unsigned count) {
  converter = trimmed(converter);
  const std::size_t open = converter.find('(');
  const std::string_view name = trimmed(converter.substr(0, open));
  std::string_view inside;
  if (open != std::string_view::npos) {
    const std::size_t close = converter.rfind(')');
    if (close == std::string_view::npos || close < open)
      return tl::unexpected(fmt::format("the converter '{}' has no ')'", converter));
    inside = converter.substr(open + 1, close - open - 1);
  }
  const Arguments arguments = arguments_of(inside);
  if (name.starts_with("std.")) return standard(name.substr(4), arguments, count);
  if (name == "expr.evaluate") return expression(arguments, count);
  return tl::unexpected(fmt::format("the converter {} has no counterpart", name));
}

// Expressions that are linear in one value: R0 / 10, (R0 - 320) * 0.05, int32(R1, R0) / 1000.

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

// Source: BlackZork/mqmgateway README.md, Data conversion, and stdconv/*.hpp: divide and multiply
// treat two registers as signed, and bits count from 1.
#include "tools/import/formats/mqm_converter.hpp"

#include <algorithm>
#include <map>

#include "tools/import/formats/expression.hpp"
#include "tools/import/formats/format.hpp"

namespace fieldcast::importing {
namespace {

struct Arguments {
  std::vector<std::string> positional;
  std::map<std::string, std::string, std::less<>> named;

  [[nodiscard]] std::string get(std::string_view name, std::size_t index) const {
    if (const auto found = named.find(name); found != named.end()) return found->second;
    return index < positional.size() ? positional[index] : std::string();
  }
  [[nodiscard]] bool flag(std::string_view name, std::size_t index) const {
    const std::string word = lower(get(name, index));
    return word == name || is_one_of(word, "true 1");
  }
};

std::string without_quotes(std::string_view text) {
  text = trimmed(text);
  const bool quoted =
      text.size() > 1 && (text[0] == '"' || text[0] == '\'') && text.back() == text[0];
  return std::string(quoted ? text.substr(1, text.size() - 2) : text);
}

void add_argument(std::string_view text, Arguments& arguments) {
  const auto [name, value] = halves(text, '=');
  const std::string_view key = trimmed(name);
  const bool named = name.size() < text.size() && !key.empty() &&
                     key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;
  if (named) {
    arguments.named.try_emplace(std::string(key), without_quotes(value));
  } else if (!trimmed(text).empty()) {
    arguments.positional.push_back(without_quotes(text));
  }
}

// Commas inside quotes and brackets do not separate arguments.
Arguments arguments_of(std::string_view text) {
  Arguments arguments;
  char quote = '\0';
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '{') {
      ++depth;
    } else if (c == ')' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      add_argument(text.substr(begin, i - begin), arguments);
      begin = i + 1;
    }
  }
  add_argument(text.substr(begin), arguments);
  return arguments;
}

void set_orders(Point& point, bool low_first, bool swap_bytes) {
  if (low_first) point.word_order = WordOrder::kLittleEndian;
  if (swap_bytes) point.byte_order = ByteOrder::kLittleEndian;
}

// divide, multiply: of one or two registers.
MayFail scaled(const Arguments& arguments, unsigned count, bool divide, Point& point) {
  const auto number = number_from(arguments.get(divide ? "divisor" : "multipler", 0));
  if (!number || *number == 0) return "a scale that is no number";
  if (count > 2) return fmt::format("a scale of {} registers", count);
  point.type = count == 2 ? ValueType::kInt32 : ValueType::kUint16;
  point.scale = divide ? 1 / *number : *number;
  set_orders(point, arguments.flag("low_first", 2), arguments.flag("swap_bytes", 3));
  return std::nullopt;
}

MayFail expression(const Arguments& arguments, unsigned count, Point& point) {
  const std::string text = arguments.get("expression", 0);
  const auto form = linear_form(text);
  if (!form) return fmt::format("the expression {} is not linear in one value", text);
  std::string_view function = form->function;
  const bool swapped = function.ends_with("bs");
  if (swapped) function.remove_suffix(2);
  constexpr Words<ValueType> kTypes[] = {{"int32", ValueType::kInt32},
                                         {"uint32", ValueType::kUint32},
                                         {"flt32", ValueType::kFloat32},
                                         {"int16", ValueType::kInt16}};
  point.type = value_of(kTypes, function).value_or(ValueType::kUint16);
  if (function.ends_with("32") && count < 2) return fmt::format("{} of one register", function);
  set_orders(point, form->low_first, swapped);
  point.scale = form->scale;
  point.offset = form->offset;
  return std::nullopt;
}

// Converters that are a type: the number of their registers, and where their flags are among the
// arguments without a name.
struct TypeConverter {
  std::string_view names;
  ValueType type;
  unsigned registers;
  std::optional<std::size_t> first, low_first, swap_bytes;
};
constexpr TypeConverter kTypeConverters[] = {
    {"int8", ValueType::kInt8, 1, 0, {}, {}},
    {"uint8", ValueType::kUint8, 1, 0, {}, {}},
    {"int16", ValueType::kInt16, 1, {}, {}, 0},
    {"uint16", ValueType::kUint16, 1, {}, {}, 0},
    {"int32", ValueType::kInt32, 2, {}, 0, 1},
    {"uint32", ValueType::kUint32, 2, {}, 0, 1},
    {"float32 float", ValueType::kFloat32, 2, {}, 1, 2}};  // after the precision

MayFail standard(std::string_view name, const Arguments& arguments, unsigned count, Point& point,
                 std::optional<std::uint8_t>& bit) {
  if (is_one_of(name, "divide multiply")) return scaled(arguments, count, name == "divide", point);
  for (const TypeConverter& converter : kTypeConverters) {
    if (!is_one_of(name, converter.names)) continue;
    if (count != converter.registers)
      return fmt::format("{} of {} registers", to_text(converter.type), count);
    const auto flag = [&](std::string_view flag_name, std::optional<std::size_t> index) {
      return index && arguments.flag(flag_name, *index);
    };
    point.type = converter.type;
    if (converter.first) point.byte = flag("first", converter.first) ? 1 : 0;
    set_orders(point, flag("low_first", converter.low_first),
               flag("swap_bytes", converter.swap_bytes));
    return std::nullopt;
  }
  if (name == "bit") {
    const auto number = whole_from(arguments.get("bit", 0), 1, 16);
    if (!number) return "a bit that is not 1 to 16";
    point.type = ValueType::kBool;
    bit = static_cast<std::uint8_t>(*number - 1);
    point.changes.emplace_back(kTruthNotNumber);
  } else if (name == "bitmask") {
    const std::string mask = arguments.get("mask", 0);
    if (!mask.empty() && whole_from(mask) != 0xFFFFu)
      return "some bits of a register; a channel has one bit or all";
  } else if (name == "string") {
    if (2 * count > kMaxStringBytes) return fmt::format("a text of {} registers", count);
    point.type = ValueType::kString;
    point.string_bytes = static_cast<std::uint16_t>(2 * count);
  } else if (name == "map") {
    if (count != 1) return "a map of several registers";
    point.changes.emplace_back("the number of the register, not the text that it is mapped to");
  } else {
    return fmt::format("the converter std.{} has no counterpart", name);
  }
  return std::nullopt;
}

}  // namespace

MayFail convert_mqm(std::string_view converter, unsigned count, Point& point,
                    std::optional<std::uint8_t>& bit) {
  converter = trimmed(converter);
  const std::size_t open = std::min(converter.find('('), converter.size());
  const std::string_view name = trimmed(converter.substr(0, open));
  std::string_view inside = converter.substr(open);
  if (!inside.empty()) {
    const std::size_t close = inside.rfind(')');
    if (close == std::string_view::npos)
      return fmt::format("the converter '{}' has no ')'", converter);
    inside = inside.substr(1, close - 1);
  }
  const Arguments arguments = arguments_of(inside);
  if (name.starts_with("std.")) return standard(name.substr(4), arguments, count, point, bit);
  if (name == "expr.evaluate") return expression(arguments, count, point);
  return fmt::format("the converter {} has no counterpart", name);
}

}  // namespace fieldcast::importing

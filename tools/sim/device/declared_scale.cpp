#include "tools/sim/device/declared_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/protocol/declared/scaled.hpp"

namespace fieldcast::sim {
namespace {

using declared::Field;
using declared::FieldKind;
using declared::Frame;

struct Number {
  long double value = 0;
  int decimals = 0;
};

Number parsed(const std::string& text) {
  const std::size_t point = text.find('.');
  const std::size_t end = std::min(text.find('\0'), text.size());
  const bool fraction = point < end;
  return {std::strtold(text.c_str(), nullptr),
          fraction ? static_cast<int>(text.find_last_not_of(" \0", end - 1) - point) : 0};
}

// Largest digits without a sign.
long double most_of(const Field& value, bool negative) {
  if (value.text_size == 0) return static_cast<long double>(largest_magnitude(value));
  const int signs = negative && !value.sign ? 1 : 0;
  return std::pow(10.0L, std::min<int>(value.text_size - signs, 18)) - 1;
}

long double digits_of(const Number& number, int exponent) {
  return std::round(std::fabs(number.value) * std::pow(10.0L, -exponent));
}

void put(const Frame& frame, std::size_t at, const Number& number, int exponent,
         DeclaredText& text) {
  const Field& value = frame.fields[at];
  const bool negative = number.value < 0;
  const auto digits =
      static_cast<std::uint64_t>(std::min(digits_of(number, exponent), most_of(value, negative)));
  const bool minus = negative && digits != 0 && !value.sign;
  text.numbers[&value] = minus ? 0 - digits : digits;
  if (value.text_size != 0) {
    std::string written = std::to_string(digits);
    written.insert(0, value.text_size - written.size() - (minus ? 1 : 0), '0');
    text.texts[&value] = (minus ? "-" : "") + written;
  }
  if (value.sign) {
    const Field& sign = frame.fields[*value.sign];
    text.numbers[&sign] = negative ? sign.on : sign.off;
  }
}

// Also of a value without an exponent: `at` is then its own index.
void put_together(const Frame& frame, std::size_t at, const declared::ExponentRange& range,
                  DeclaredText& text) {
  std::vector<std::pair<std::size_t, Number>> values;
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const Field& field = frame.fields[i];
    if (field.scaled() && (i == at || field.exponent == at))
      values.emplace_back(i, parsed(text.texts[&field]));
  }
  int exponent = range.highest;
  for (const auto& [i, number] : values)
    exponent = std::min(exponent, std::max(range.lowest, -number.decimals));
  const auto fits = [&](const auto& each) {
    return digits_of(each.second, exponent) <=
           most_of(frame.fields[each.first], each.second.value < 0);
  };
  while (exponent < range.highest && !std::ranges::all_of(values, fits)) ++exponent;
  for (const auto& [i, number] : values) put(frame, i, number, exponent, text);
  const Field& field = frame.fields[at];
  if (!declared::scales(field)) return;
  const std::int64_t sent =
      (field.kind == FieldKind::kDecimals ? -exponent : exponent) + field.plus;
  text.numbers[&field] = static_cast<std::uint64_t>(field.sign ? std::abs(sent) : sent);
  if (!field.sign) return;
  const Field& sign = frame.fields[*field.sign];
  text.numbers[&sign] = sent < 0 ? sign.on : sign.off;
}

std::int64_t with_sign(const Field& field, std::uint64_t number) {
  const bool negative = field.is_signed && (number >> (field.bits - 1) & 1u) != 0;
  return static_cast<std::int64_t>(negative && field.bits < 64 ? number | UINT64_MAX << field.bits
                                                               : number);
}

std::string text_of(const Frame& frame, const Field& value, DeclaredText& text) {
  std::int64_t whole = value.text_size != 0 ? std::strtoll(text.texts[&value].c_str(), nullptr, 10)
                                            : with_sign(value, text.numbers[&value]);
  const bool marked =
      value.sign && text.numbers[&frame.fields[*value.sign]] == frame.fields[*value.sign].on;
  if (marked) whole = -whole;
  std::int64_t exponent = 0;
  if (value.exponent) {
    const Field& field = frame.fields[*value.exponent];
    exponent = with_sign(field, text.numbers[&field]);
    if (field.sign && text.numbers[&frame.fields[*field.sign]] == frame.fields[*field.sign].on)
      exponent = -exponent;
    exponent -= field.plus;
    if (field.kind == FieldKind::kDecimals) exponent = -exponent;
  }
  exponent = std::clamp<std::int64_t>(exponent, -20, 20);
  std::string digits = std::to_string(std::abs(whole));
  if (exponent > 0 && whole != 0) digits.append(static_cast<std::size_t>(exponent), '0');
  if (exponent < 0) {
    const auto decimals = static_cast<std::size_t>(-exponent);
    if (digits.size() <= decimals) digits.insert(0, decimals + 1 - digits.size(), '0');
    digits.insert(digits.size() - decimals, ".");
  }
  return (whole < 0 ? "-" : "") + digits;
}

}  // namespace

void texts_to_fields(const Frame& frame, DeclaredText& text) {
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const Field& field = frame.fields[i];
    if (field.kind == FieldKind::kExponent || field.kind == FieldKind::kDecimals)
      put_together(frame, i, exponents_of(field), text);
    else if (field.scaled() && !field.exponent)
      put_together(frame, i, {}, text);
  }
}

void fields_to_texts(const Frame& frame, DeclaredText& text) {
  for (const Field& field : frame.fields) {
    if (field.scaled()) text.texts[&field] = text_of(frame, field, text);
  }
  for (const Field& field : frame.fields) {
    if (field.scaled() || declared::scales(field)) text.numbers.erase(&field);
  }
}

}  // namespace fieldcast::sim

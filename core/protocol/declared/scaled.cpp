#include "core/protocol/declared/scaled.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "core/codec/text_codec.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::declared {
namespace {

constexpr int kMostExponent = 128;
// 10^19 is the largest power in 64 bits.
constexpr int kMostDropped = 19;

std::uint64_t mask(unsigned bits) { return bits == 0 ? 0 : UINT64_MAX >> (64 - bits); }

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\0'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

bool append_digit(std::uint64_t& number, unsigned digit) {
  if (number > (UINT64_MAX - digit) / 10) return false;
  number = number * 10 + digit;
  return true;
}

// The number of one field; empty if a character is not a digit.
std::optional<std::uint64_t> number_at(const Frame& frame, std::size_t at, ByteView bytes,
                                       std::span<const std::size_t> starts) {
  std::size_t opener = at;
  while (opener > 0 && !frame.fields[opener].opens) --opener;
  const Field& word = frame.fields[opener];
  const auto number = read_word(
      word.transform.meant(bytes.subspan(starts[opener], word.word.characters)), word.word);
  if (!number) return std::nullopt;
  return *number >> frame.fields[at].shift & mask(frame.fields[at].bits);
}

std::int64_t signed_number(const Field& field, std::uint64_t number) {
  const bool negative = field.is_signed && (number >> (field.bits - 1) & 1u) != 0;
  return static_cast<std::int64_t>(negative && field.bits < 64 ? number | ~mask(field.bits)
                                                               : number);
}

// Digits of the decimal at this exponent, rounded. Empty if they do not fit, or if digits before
// the point would be lost.
std::optional<std::uint64_t> digits_at(const Decimal& decimal, int exponent) {
  std::uint64_t digits = decimal.digits;
  for (int i = decimal.exponent; i > exponent; --i) {
    if (!append_digit(digits, 0)) return std::nullopt;
  }
  const int dropped = exponent - decimal.exponent;
  if (dropped <= 0 || digits == 0) return digits;
  if (dropped > kMostDropped) return exponent <= 0 ? std::optional<std::uint64_t>(0) : std::nullopt;
  std::uint64_t power = 1;
  for (int i = 0; i < dropped; ++i) power *= 10;
  if (exponent > 0 && digits % power != 0) return std::nullopt;
  return digits / power + (digits % power >= power - power / 2 ? 1 : 0);
}

// What the field of the value sends. Empty if it cannot hold the number.
std::optional<std::uint64_t> raw_of(const Field& value, const Decimal& decimal, int exponent) {
  const auto digits = digits_at(decimal, exponent);
  if (!digits) return std::nullopt;
  const bool minus = decimal.negative && *digits != 0 && !value.sign;
  if (minus && *digits > mask(63)) return std::nullopt;
  const std::uint64_t raw = minus ? 0 - *digits : *digits;
  if (value.text_size != 0) {
    const Value number = minus ? Value{static_cast<std::int64_t>(raw)} : Value{raw};
    return write_decimal(value.text_number, value.text_size, number, false) ? std::optional(raw)
                                                                            : std::nullopt;
  }
  if (*digits > largest_magnitude(value) || (minus && !value.is_signed)) return std::nullopt;
  return raw & mask(value.bits);
}

// The values that share the exponent of the field `at`; without one, only the value `at` itself.
std::vector<std::size_t> values_scaled_by(const Frame& frame, std::size_t at) {
  if (frame.fields[at].kind == FieldKind::kValue) return {at};
  std::vector<std::size_t> values;
  for (std::size_t i = frame.fields[at].of.from; i <= frame.fields[at].of.to; ++i) {
    if (frame.fields[i].exponent == at) values.push_back(i);
  }
  return values;
}

using Numbers = std::map<std::size_t, std::uint64_t>;

// Puts the numbers of these values at the lowest exponent at which all of them fit.
std::optional<int> fit(const Frame& frame, std::span<const std::size_t> values,
                       const std::map<std::size_t, Decimal>& decimals, ExponentRange range,
                       Numbers& numbers) {
  int exponent = range.highest;
  for (const std::size_t at : values)
    exponent = std::min(exponent, std::max(range.lowest, decimals.at(at).exponent));
  for (; exponent <= range.highest; ++exponent) {
    const bool all = std::ranges::all_of(values, [&](std::size_t at) {
      const auto raw = raw_of(frame.fields[at], decimals.at(at), exponent);
      if (raw) numbers[at] = *raw;
      return raw.has_value();
    });
    if (all) return exponent;
  }
  return std::nullopt;
}

}  // namespace

bool Decimal::rounds_to(const Decimal& other) const {
  return digits_at(*this, other.exponent) == other.digits &&
         (negative == other.negative || other.digits == 0);
}

std::optional<Decimal> decimal_from(std::string_view text) {
  text = trimmed(text);
  Decimal decimal;
  if (text.starts_with('-') || text.starts_with('+')) {
    decimal.negative = text.starts_with('-');
    text = trimmed(text.substr(1));
  }
  bool digits = false, fraction = false;
  std::size_t at = 0;
  for (; at < text.size() && text[at] != 'e' && text[at] != 'E'; ++at) {
    const bool mark = text[at] == '.' || text[at] == ',';
    if (mark ? fraction : (text[at] < '0' || text[at] > '9')) return std::nullopt;
    fraction = fraction || mark;
    if (mark) continue;
    digits = true;
    if (!append_digit(decimal.digits, static_cast<unsigned>(text[at] - '0'))) return std::nullopt;
    decimal.exponent -= fraction ? 1 : 0;
  }
  if (!digits) return std::nullopt;
  if (at == text.size()) return decimal;
  text.remove_prefix(at + 1);
  if (text.starts_with('+')) text.remove_prefix(1);
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (error != std::errc{} || end != text.data() + text.size() || std::abs(exponent) > 999)
    return std::nullopt;
  decimal.exponent += exponent;
  return decimal;
}

std::string to_text(const Decimal& decimal) {
  std::string text = std::to_string(decimal.digits);
  const std::string sign = decimal.negative && decimal.digits != 0 ? "-" : "";
  const auto decimals = static_cast<std::size_t>(std::max(0, -decimal.exponent));
  const auto zeros = static_cast<std::size_t>(std::max(0, decimal.exponent));
  const std::size_t size = std::max(text.size(), decimals + 1) + zeros + (decimals != 0 ? 1 : 0);
  if (sign.size() + size > kScaledCharacters)
    return sign + text + "e" + std::to_string(decimal.exponent);
  if (decimal.digits != 0) text.append(zeros, '0');
  if (text.size() <= decimals) text.insert(0, decimals + 1 - text.size(), '0');
  if (decimals != 0) text.insert(text.size() - decimals, 1, '.');
  return sign + text;
}

std::optional<Decimal> scaled_value(const Frame& frame, std::size_t at, ByteView bytes,
                                    std::span<const std::size_t> starts) {
  const Field& value = frame.fields[at];
  std::optional<Decimal> decimal;
  if (value.text_size != 0) {
    const Bytes text =
        value.transform.meant(bytes.subspan(starts[at], starts[at + 1] - starts[at]));
    decimal = decimal_from({reinterpret_cast<const char*>(text.data()), text.size()});
  } else if (const auto number = number_at(frame, at, bytes, starts)) {
    const std::int64_t whole = signed_number(value, *number);
    const bool negative = value.is_signed && whole < 0;
    const auto digits = static_cast<std::uint64_t>(whole);
    decimal = Decimal{negative, negative ? 0 - digits : digits, 0};
  }
  if (!decimal) return std::nullopt;
  if (value.exponent) {
    const Field& field = frame.fields[*value.exponent];
    const auto number = number_at(frame, *value.exponent, bytes, starts);
    if (!number) return std::nullopt;
    std::int64_t exponent = signed_number(field, *number);
    if (field.sign) {
      const auto sign = number_at(frame, *field.sign, bytes, starts);
      if (sign == frame.fields[*field.sign].on) exponent = -exponent;
    }
    exponent -= field.plus;
    if (exponent < -kMostExponent || exponent > kMostExponent) return std::nullopt;
    decimal->exponent +=
        static_cast<int>(field.kind == FieldKind::kDecimals ? -exponent : exponent);
  }
  if (value.sign) {
    const Field& field = frame.fields[*value.sign];
    const auto number = number_at(frame, *value.sign, bytes, starts);
    if (!number) return std::nullopt;
    decimal->negative = decimal->negative != (*number == field.on);
  }
  return decimal;
}

ExponentRange exponents_of(const Field& exponent) {
  const std::uint64_t most =
      std::min({largest(exponent.word), mask(exponent.bits - (exponent.is_signed ? 1u : 0u)),
                std::uint64_t{1} << 40});
  const std::int64_t high = static_cast<std::int64_t>(most) - exponent.plus;
  const std::int64_t low =
      (exponent.is_signed || exponent.sign ? -static_cast<std::int64_t>(most) : 0) - exponent.plus;
  const auto limited = [](std::int64_t number) {
    return static_cast<int>(std::clamp<std::int64_t>(number, -kMostExponent, kMostExponent));
  };
  if (exponent.kind == FieldKind::kDecimals) return {limited(-high), limited(-low)};
  return {limited(low), limited(high)};
}

std::uint64_t largest_magnitude(const Field& value) {
  return std::min(largest(value.word), mask(value.bits - (value.is_signed ? 1u : 0u)));
}

std::optional<Numbers> scaled_numbers(const Frame& frame, ByteView items, std::uint32_t first) {
  Numbers numbers;
  std::map<std::size_t, Decimal> decimals;
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const Field& field = frame.fields[i];
    if (!field.scaled()) continue;
    const auto text = items.subspan(2 * (field.place - first), kScaledCharacters);
    const auto decimal = decimal_from({reinterpret_cast<const char*>(text.data()), text.size()});
    if (!decimal) return std::nullopt;
    decimals[i] = *decimal;
    if (field.sign)
      numbers[*field.sign] =
          decimal->negative ? frame.fields[*field.sign].on : frame.fields[*field.sign].off;
  }
  for (std::size_t i = 0; i < frame.fields.size() && !decimals.empty(); ++i) {
    const Field& field = frame.fields[i];
    const bool sends = field.kind == FieldKind::kExponent || field.kind == FieldKind::kDecimals;
    if (!sends && !(field.scaled() && !field.exponent)) continue;
    const auto exponent = fit(frame, values_scaled_by(frame, i), decimals,
                              sends ? exponents_of(field) : ExponentRange{}, numbers);
    if (!exponent) return std::nullopt;
    if (!sends) continue;
    const std::int64_t sent =
        (field.kind == FieldKind::kDecimals ? -*exponent : *exponent) + field.plus;
    numbers[i] = static_cast<std::uint64_t>(field.sign ? std::abs(sent) : sent);
    if (!field.sign) continue;
    const Field& sign = frame.fields[*field.sign];
    numbers[*field.sign] = sent < 0 ? sign.on : sign.off;
  }
  return numbers;
}

}  // namespace fieldcast::declared

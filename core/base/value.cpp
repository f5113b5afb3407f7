#include "core/base/value.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/time.hpp"

namespace fieldcast {

namespace {

template <typename Number>
std::string shortest(Number number) {
  if (std::isnan(number)) return "nan";  // regardless of its sign bit
  constexpr Number kLeast = static_cast<Number>(1e-4), kMost = static_cast<Number>(1e16);
  const Number magnitude = std::abs(number);
  const bool plain = magnitude == 0 || (magnitude >= kLeast && magnitude < kMost);
  std::array<char, 32> buffer{};  // sign, 17 digits, point, exponent; or four zeros and a point
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                 plain ? std::chars_format::fixed : std::chars_format::scientific)
                       .ptr;
  return {buffer.data(), end};
}

}  // namespace

std::string number_text(double number) { return shortest(number); }

std::string float32_text(double number) {
  const bool in_range = !(std::abs(number) > std::numeric_limits<float>::max());
  const float single = in_range ? static_cast<float>(number) : 0.0F;
  return static_cast<double>(single) == number ? shortest(single) : shortest(number);
}

std::string to_text(Duration d) {
  struct Unit {
    std::string_view name;
    std::int64_t worth, from;  // nanoseconds; used from this duration on
  };
  constexpr std::int64_t kMinute = 60'000'000'000, kHour = 60 * kMinute, kDay = 24 * kHour;
  static constexpr Unit kWhole[] = {
      {"d", kDay, 2 * kDay}, {"h", kHour, kHour}, {"min", kMinute, 2 * kMinute}};
  static constexpr Unit kParts[] = {{"s", 1'000'000'000, 1'000'000'000},
                                    {"ms", 1'000'000, 1'000'000}};
  const auto ns = d.count();
  const auto magnitude = ns < 0 ? -ns : ns;
  const auto spelt = [&](std::int64_t worth, std::string_view name) {
    return number_text(static_cast<double>(ns) / static_cast<double>(worth)).append(name);
  };
  if (ns == 0) return "0s";
  for (const auto& [name, worth, from] : kWhole) {
    if (magnitude >= from && magnitude % worth == 0) return spelt(worth, name);
  }
  for (const auto& [name, worth, from] : kParts) {
    if (magnitude >= from) return spelt(worth, name);
  }
  return spelt(1000, "us");
}

std::optional<double> as_number(const Value& value) {
  if (const auto* d = std::get_if<double>(&value)) return *d;
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*u);
  return std::nullopt;
}

std::string to_text(const Value& value) {
  struct Spell {
    std::string operator()(bool b) const { return b ? "true" : "false"; }
    std::string operator()(std::int64_t i) const { return std::to_string(i); }
    std::string operator()(std::uint64_t u) const { return std::to_string(u); }
    std::string operator()(double d) const { return number_text(d); }
    std::string operator()(const std::string& s) const { return s; }
  };
  return std::visit(Spell{}, value);
}

}  // namespace fieldcast

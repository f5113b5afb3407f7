// Spellings of times and values (time.hpp, value.hpp).
#include <array>
#include <charconv>

#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {
namespace {

std::string number_text(double number) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  return {buffer.data(), end};
}

}  // namespace

std::string to_text(Duration d) {
  const auto ns = d.count();
  const auto magnitude = ns < 0 ? -ns : ns;
  if (magnitude < 1'000'000) return number_text(static_cast<double>(ns) / 1e3) + "us";
  if (magnitude < 1'000'000'000) return number_text(static_cast<double>(ns) / 1e6) + "ms";
  if (magnitude >= 120'000'000'000 && magnitude % 60'000'000'000 == 0) return number_text(static_cast<double>(ns) / 60e9) + "min";
  return number_text(static_cast<double>(ns) / 1e9) + "s";
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

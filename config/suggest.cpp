#include "config/suggest.hpp"

#include <algorithm>
#include <utility>

#include "core/base/near_miss.hpp"

namespace fieldcast::config {

namespace {

// What other programs call things, and one misspelling that is nearer to another word.
constexpr std::pair<std::string_view, std::string_view> kHabits[] = {
    {"address", "at"},       {"adress", "at"},        {"addr", "at"},       {"register", "at"},    {"slave", "address"},
    {"slave-id", "address"}, {"unit-id", "address"},  {"id", "address"},    {"period", "refresh"}, {"poll", "refresh"},
    {"cycle", "refresh"},    {"interval", "refresh"}, {"baudrate", "baud"}, {"baud-rate", "baud"}, {"parity", "format"},
    {"stop-bits", "format"}, {"host", "tcp"},         {"path", "serial"},   {"units", "unit"},     {"comment", "description"},
    {"factor", "scale"},     {"gain", "scale"},       {"datatype", "type"}, {"data-type", "type"}, {"tags", "channels"}};

}  // namespace

std::string closest(std::string_view word, std::span<const std::string_view> candidates) {
  for (const auto& [habit, ours] : kHabits) {
    if (word == habit && std::ranges::find(candidates, ours) != candidates.end()) return std::string(ours);
  }
  const auto near = near_miss(word, candidates);
  if (!near.empty() || word.size() < 3) return std::string(near);
  for (const auto candidate : candidates) {
    if (candidate.starts_with(word)) return std::string(candidate);
  }
  return {};
}

std::string joined(std::span<const std::string_view> words) {
  std::string result;
  for (const auto word : words) {
    if (!result.empty()) result += ", ";
    result += word;
  }
  return result;
}

}  // namespace fieldcast::config

#include "config/suggest.hpp"

#include "core/protocol/near_miss.hpp"

namespace fieldcast::config {

std::string closest(std::string_view word, std::span<const std::string_view> candidates) {
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

#include "core/frame/line.hpp"

#include <algorithm>

namespace fieldcast {

Duration silence_of(const SilenceRule& rule, const LineFormat& line) {
  if (const auto* fixed = std::get_if<Duration>(&rule)) return *fixed;
  if (const auto* characters = std::get_if<CharacterSilence>(&rule))
    return line.characters(characters->characters);
  if (line.baud > 19200) return std::chrono::microseconds{1750};
  return Duration{static_cast<std::int64_t>(3.5 * 11 * 1e9 / line.baud + 0.5)};
}

Duration least_silence(const LearnedSilence& rule, const LineFormat& line) {
  return std::max({rule.least, line.characters(1.5), Duration{std::chrono::microseconds{300}}});
}

}  // namespace fieldcast

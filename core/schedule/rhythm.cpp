#include "core/schedule/rhythm.hpp"

#include <algorithm>
#include <cmath>

namespace fieldcast {

std::int64_t due_after(const Beat& beat, std::int64_t acquired, std::int64_t period) {
  constexpr double kWorth = 0.7;  // of the period: a beat before that is not waited for
  const std::int64_t latest = acquired + period;
  if (beat.spacing <= 0) return latest;
  std::int64_t past = (latest - beat.offset) % beat.spacing;
  if (past < 0) past += beat.spacing;
  return static_cast<double>(period - past) >= kWorth * static_cast<double>(period) ? latest - past : latest;
}

std::int64_t beat_spacing(std::int64_t period, std::int64_t fastest, double margin) {
  const auto beat = static_cast<std::int64_t>(static_cast<double>(fastest) * (1 - margin));
  if (beat <= 0) return 0;
  // Of two beats' period both count, though the margin would allow a little more than two.
  const auto usable = static_cast<std::int64_t>(static_cast<double>(period) * (1 - margin));
  return std::max<std::int64_t>(1, (usable + beat / 1000) / beat) * beat;
}

Leveller::Leveller(std::int64_t beat) : beat_(std::max<std::int64_t>(1, beat)), slots_(kBeats * kSlots, 0.0) {}

double Leveller::crowd(std::int64_t offset, std::int64_t spacing) const {
  const std::int64_t table = beat_ * static_cast<std::int64_t>(kBeats);
  double sum = 0;
  int count = 0;
  for (std::int64_t at = offset; at < std::max(table, offset + 1); at += spacing, ++count) {
    const auto slot = static_cast<std::size_t>(static_cast<double>(at % table) / static_cast<double>(beat_) * kSlots);
    // The beat around the instant, and nearer its neighbours.
    for (std::size_t near = 0; near < kSlots; ++near) {
      const std::size_t distance = near < kSlots / 2 ? kSlots / 2 - near : near - kSlots / 2;
      const double weight = 1.0 / static_cast<double>(2 + distance);
      sum += weight * slots_[(slot + kSlots * kBeats + near - kSlots / 2) % slots_.size()];
    }
  }
  return sum / std::max(1, count);
}

void Leveller::take(std::int64_t offset, std::int64_t spacing, std::int64_t cost) {
  const std::int64_t table = beat_ * static_cast<std::int64_t>(kBeats);
  const double share = spacing > table ? static_cast<double>(table) / static_cast<double>(spacing) : 1.0;
  for (std::int64_t at = offset; at < std::max(table, offset + 1); at += spacing) {
    const auto slot = static_cast<std::size_t>(static_cast<double>(at % table) / static_cast<double>(beat_) * kSlots);
    slots_[std::min(slot, slots_.size() - 1)] += share * static_cast<double>(cost);
  }
}

std::int64_t Leveller::place(std::int64_t spacing, std::int64_t cost) {
  double least = 0;
  std::int64_t best = 0;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const double phase = std::fmod(0.6180339887498949 * ++turn_, 1.0);
    const auto offset = static_cast<std::int64_t>(phase * static_cast<double>(spacing));
    const double crowded = crowd(offset, spacing);
    if (attempt == 0 || crowded < least) least = crowded, best = offset;
  }
  take(best, spacing, cost);
  return best;
}

std::int64_t Leveller::place_on(const Beat& beat, std::int64_t count, std::int64_t cost) {
  double least = 0;
  std::int64_t best = 0;
  const std::int64_t step = std::max<std::int64_t>(1, count / kTries);
  for (std::int64_t turn = 0; turn < count; turn += step) {
    const double crowded = crowd(beat.offset + turn * beat.spacing, count * beat.spacing);
    if (turn == 0 || crowded < least) least = crowded, best = turn;
  }
  take(beat.offset + best * beat.spacing, count * beat.spacing, cost);
  return best;
}

}  // namespace fieldcast

#include "tools/sim/bus/faults.hpp"

#include <algorithm>

namespace fieldcast::sim {

bool FaultDice::happens(double probability) {
  return probability > 0 && std::generate_canonical<double, 53>(random_) < probability;
}

bool FaultDice::dead(Duration since_start) const {
  return std::ranges::any_of(faults_.silence,
                             [&](const Window& window) { return window.holds(since_start); });
}

FaultyResponse FaultDice::roll(Bytes answer) {
  FaultyResponse out{std::move(answer), faults_.delay.base};
  if (faults_.delay.spread > Duration{}) {
    out.delay +=
        Duration{static_cast<std::int64_t>(std::generate_canonical<double, 53>(random_) *
                                           static_cast<double>(faults_.delay.spread.count()))};
  }
  if (happens(faults_.delay.spike_probability)) out.delay += faults_.delay.spike;
  if (happens(faults_.late_probability)) {
    out.delay += faults_.late;
    ++late_;
  }
  if (happens(faults_.garble)) {
    for (std::uint64_t hits = 1 + random_() % 3; hits > 0 && !out.characters.empty(); --hits) {
      std::uint8_t& character = out.characters[random_() % out.characters.size()];
      character = static_cast<std::uint8_t>(character ^ (1 + random_() % 255));
    }
  }
  if (happens(faults_.truncate))
    out.characters.resize(random_() % std::max<std::size_t>(1, out.characters.size()));
  if (happens(faults_.stray)) {
    Bytes stray(4 + random_() % 12);
    for (std::uint8_t& character : stray) character = static_cast<std::uint8_t>(random_());
    out.characters.insert(out.characters.begin(), stray.begin(), stray.end());
  }
  if (happens(faults_.loss)) out.characters.clear();
  out.doubled = happens(faults_.doubled);
  doubled_ += out.doubled ? 1 : 0;
  return out;
}

}  // namespace fieldcast::sim

#include "tools/sim/bus/wire.hpp"

#include <algorithm>
#include <cmath>

namespace fieldcast::sim {

Wire::Wire(const WireOptions& options)
    : options_(options),
      character_(options.paced ? options.line.characters(1) : Duration{}),
      noise_(options.noise, options.line.bits_per_character(), options.seed) {}

void Wire::collide(Queued& queued, Transmission& transmission) {
  const Instant begin = queued.end - character_;
  if (begin >= end_of(transmission, transmission.characters.size()) ||
      queued.end <= transmission.start)
    return;
  queued.garbled = true;
  ++collisions_;
  for (std::size_t i = transmission.passed; i < transmission.characters.size(); ++i) {
    if (begin < end_of(transmission, i + 1) && queued.end > end_of(transmission, i))
      transmission.garbled[i] = true;
  }
}

void Wire::collide(Transmission& a, Transmission& b) {
  bool any = false;
  for (std::size_t i = a.passed; i < a.characters.size(); ++i) {
    for (std::size_t k = b.passed; k < b.characters.size(); ++k) {
      if (end_of(a, i) >= end_of(b, k + 1) || end_of(a, i + 1) <= end_of(b, k)) continue;
      a.garbled[i] = b.garbled[k] = any = true;
    }
  }
  collisions_ += any ? 1 : 0;
}

void Wire::from_master(ByteView characters, Instant now,
                       std::optional<std::uint32_t> response_baud) {
  response_baud_ = response_baud;
  const std::size_t room = kMaxQueued - queued_.size();
  lost_ += characters.size() - std::min(room, characters.size());
  characters = characters.first(std::min(room, characters.size()));
  if (characters.empty()) return;
  const Instant start = std::max(now, master_free_);
  if (queued_.empty() && transmission_ended_ != kLongAgo && now >= transmission_ended_ &&
      now > master_free_) {
    const Duration rest = now - std::max(transmission_ended_, master_free_);
    shortest_rest_ = std::min(shortest_rest_.value_or(rest), rest);
  }
  master_free_ =
      start + Duration{static_cast<std::int64_t>(characters.size()) * character_.count()};
  Instant end = start;
  for (const std::uint8_t character : characters) {
    end += character_;
    Queued& queued = queued_.emplace_back(Queued{noise_.pass(character), end, master_free_, false});
    if (!options_.half_duplex) continue;
    for (Transmission& transmission : transmissions_) collide(queued, transmission);
  }
  if (options_.echo)
    transmissions_.push_back(Transmission{kEcho,
                                          {characters.begin(), characters.end()},
                                          std::vector<bool>(characters.size()),
                                          start});
}

void Wire::from_device(Sender sender, ByteView characters, Instant start, std::uint32_t baud) {
  if (characters.empty()) return;
  Transmission transmission{
      sender,
      {characters.begin(), characters.end()},
      std::vector<bool>(characters.size(), response_baud_.value_or(baud) != baud),
      start,
      baud};
  if (options_.half_duplex && options_.paced) {
    for (Queued& queued : queued_) collide(queued, transmission);
    for (Transmission& other : transmissions_) {
      if (other.sender != kEcho) collide(transmission, other);
    }
  }
  transmissions_.push_back(std::move(transmission));
}

Instant Wire::piece_end(const Transmission& transmission) const {
  const std::size_t size = transmission.characters.size();
  return end_of(transmission, options_.fifo == 0 || !options_.paced
                                  ? size
                                  : std::min(size, transmission.passed + options_.fifo));
}

Instant Wire::next_due() const {
  Instant due = queued_.empty() ? kNever : queued_.front().piece_end;
  for (const Transmission& transmission : transmissions_)
    due = std::min(due, piece_end(transmission));
  return due;
}

Instant Wire::sends_until(Sender sender) const {
  Instant until = kLongAgo;
  for (const Transmission& transmission : transmissions_) {
    if (transmission.sender == sender)
      until = std::max(until, end_of(transmission, transmission.characters.size()));
  }
  return until;
}

bool Wire::sending(Sender sender, Instant at) const {
  return std::ranges::any_of(transmissions_, [&](const Transmission& transmission) {
    return transmission.sender == sender && transmission.start < at &&
           end_of(transmission, transmission.characters.size()) >= at;
  });
}

Passed Wire::pass_queued() {
  const Queued queued = queued_.front();
  queued_.pop_front();
  return {kMaster,
          {queued.garbled ? noise_.garble(queued.character) : queued.character},
          queued.end,
          character_};
}

Passed Wire::pass_transmission(std::size_t index) {
  Transmission& transmission = transmissions_[index];
  const Instant until = piece_end(transmission);
  Passed passed{transmission.sender,
                {},
                end_of(transmission, transmission.passed + 1),
                character_of(transmission)};
  for (; transmission.passed < transmission.characters.size() &&
         end_of(transmission, transmission.passed + 1) <= until;
       ++transmission.passed) {
    const std::uint8_t character = transmission.characters[transmission.passed];
    passed.characters.push_back(transmission.garbled[transmission.passed] ? noise_.garble(character)
                                                                          : noise_.pass(character));
  }
  transmission_ended_ = std::max(transmission_ended_, until);
  if (transmission.passed == transmission.characters.size())
    transmissions_.erase(transmissions_.begin() + static_cast<std::ptrdiff_t>(index));
  return passed;
}

std::optional<Passed> Wire::advance(Instant now) {
  Instant earliest = queued_.empty() ? kNever : queued_.front().end;
  std::optional<std::size_t> sending;
  for (std::size_t i = 0; i < transmissions_.size(); ++i) {
    if (piece_end(transmissions_[i]) >= earliest) continue;
    earliest = piece_end(transmissions_[i]);
    sending = i;
  }
  if (earliest > now || earliest == kNever) return std::nullopt;
  return sending ? pass_transmission(*sending) : pass_queued();
}

BitNoise::BitNoise(double rate, unsigned bits_per_character, std::uint64_t seed)
    : rate_(rate), bits_(bits_per_character), random_(seed) {
  draw();
}

void BitNoise::draw() {
  if (rate_ <= 0) return;
  // The number of good bits is geometrically distributed; 1e15 bits exceed any run.
  const double gap = rate_ >= 1
                         ? 0
                         : std::floor(std::log1p(-std::generate_canonical<double, 53>(random_)) /
                                      std::log1p(-rate_));
  bits_left_ = static_cast<std::uint64_t>(std::min(gap, 1e15));
}

std::uint8_t BitNoise::pass(std::uint8_t character) {
  if (rate_ <= 0) return character;
  unsigned used = 0;
  while (bits_left_ < bits_ - used) {
    used += static_cast<unsigned>(bits_left_) + 1;
    // Bits 1..8 are data. A flipped start, parity or stop bit usually gives a wrong character.
    character =
        static_cast<std::uint8_t>(character ^ (used >= 2 && used <= 9 ? 1u << (used - 2) : 0x55u));
    draw();
  }
  bits_left_ -= bits_ - used;
  return character;
}

std::uint8_t BitNoise::garble(std::uint8_t character) {
  return static_cast<std::uint8_t>(character ^ (1 + random_() % 255));
}

bool FaultDice::happens(double probability) {
  return probability > 0 && std::generate_canonical<double, 53>(random_) < probability;
}

bool FaultDice::dead(Duration since_start) const {
  return std::ranges::any_of(faults_.silence,
                             [&](const Window& window) { return window.holds(since_start); });
}

FaultyResponse FaultDice::roll(Bytes response) {
  FaultyResponse out{std::move(response), faults_.delay.base};
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

#include "tools/sim/bus/wire.hpp"

#include <algorithm>

namespace fieldcast::sim {

Wire::Wire(const WireOptions& options)
    : options_(options),
      character_(options.paced ? options.line.characters(1) : Duration{}),
      noise_(options.noise, options.line.bits_per_character(), options.seed) {}

void Wire::collide(Queued& queued, Talk& talk) {
  const Instant begin = queued.end - character_;
  if (begin >= end_of(talk, talk.characters.size()) || queued.end <= talk.start) return;
  queued.garbled = true;
  ++collisions_;
  for (std::size_t i = talk.passed; i < talk.characters.size(); ++i) {
    if (begin < end_of(talk, i + 1) && queued.end > end_of(talk, i)) talk.garbled[i] = true;
  }
}

void Wire::collide(Talk& a, Talk& b) {
  bool any = false;
  for (std::size_t i = a.passed; i < a.characters.size(); ++i) {
    for (std::size_t k = b.passed; k < b.characters.size(); ++k) {
      if (end_of(a, i) >= end_of(b, k + 1) || end_of(a, i + 1) <= end_of(b, k)) continue;
      a.garbled[i] = b.garbled[k] = any = true;
    }
  }
  collisions_ += any ? 1 : 0;
}

void Wire::from_master(ByteView characters, Instant now) {
  const std::size_t room = kMaxQueued - queued_.size();
  lost_ += characters.size() - std::min(room, characters.size());
  characters = characters.first(std::min(room, characters.size()));
  if (characters.empty()) return;
  const Instant start = std::max(now, master_free_);
  if (queued_.empty() && talk_ended_ != kLongAgo && now >= talk_ended_ && now > master_free_) {
    const Duration rest = now - std::max(talk_ended_, master_free_);
    shortest_rest_ = std::min(shortest_rest_.value_or(rest), rest);
  }
  master_free_ =
      start + Duration{static_cast<std::int64_t>(characters.size()) * character_.count()};
  Instant end = start;
  for (const std::uint8_t character : characters) {
    end += character_;
    Queued& queued = queued_.emplace_back(Queued{noise_.pass(character), end, master_free_, false});
    if (!options_.half_duplex) continue;
    for (Talk& talk : talks_) collide(queued, talk);
  }
  if (options_.echo)
    talks_.push_back(Talk{kEcho,
                          {characters.begin(), characters.end()},
                          std::vector<bool>(characters.size()),
                          start});
}

void Wire::from_device(Speaker speaker, ByteView characters, Instant start) {
  if (characters.empty()) return;
  Talk talk{
      speaker, {characters.begin(), characters.end()}, std::vector<bool>(characters.size()), start};
  if (options_.half_duplex && options_.paced) {
    for (Queued& queued : queued_) collide(queued, talk);
    for (Talk& other : talks_) {
      if (other.speaker != kEcho) collide(talk, other);
    }
  }
  talks_.push_back(std::move(talk));
}

Instant Wire::piece_end(const Talk& talk) const {
  const std::size_t size = talk.characters.size();
  return end_of(talk, options_.fifo == 0 || !options_.paced
                          ? size
                          : std::min(size, talk.passed + options_.fifo));
}

Instant Wire::next_due() const {
  Instant due = queued_.empty() ? kNever : queued_.front().piece_end;
  for (const Talk& talk : talks_) due = std::min(due, piece_end(talk));
  return due;
}

Instant Wire::talks_until(Speaker speaker) const {
  Instant until = kLongAgo;
  for (const Talk& talk : talks_) {
    if (talk.speaker == speaker) until = std::max(until, end_of(talk, talk.characters.size()));
  }
  return until;
}

bool Wire::talking(Speaker speaker, Instant at) const {
  return std::any_of(talks_.begin(), talks_.end(), [&](const Talk& talk) {
    return talk.speaker == speaker && talk.start < at && end_of(talk, talk.characters.size()) >= at;
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

Passed Wire::pass_talk(std::size_t index) {
  Talk& talk = talks_[index];
  const Instant until = piece_end(talk);
  Passed passed{talk.speaker, {}, end_of(talk, talk.passed + 1), character_};
  for (; talk.passed < talk.characters.size() && end_of(talk, talk.passed + 1) <= until;
       ++talk.passed) {
    const std::uint8_t character = talk.characters[talk.passed];
    passed.characters.push_back(talk.garbled[talk.passed] ? noise_.garble(character)
                                                          : noise_.pass(character));
  }
  talk_ended_ = std::max(talk_ended_, until);
  if (talk.passed == talk.characters.size())
    talks_.erase(talks_.begin() + static_cast<std::ptrdiff_t>(index));
  return passed;
}

std::optional<Passed> Wire::advance(Instant now) {
  Instant earliest = queued_.empty() ? kNever : queued_.front().end;
  std::optional<std::size_t> talking;
  for (std::size_t i = 0; i < talks_.size(); ++i) {
    if (piece_end(talks_[i]) >= earliest) continue;
    earliest = piece_end(talks_[i]);
    talking = i;
  }
  if (earliest > now || earliest == kNever) return std::nullopt;
  return talking ? pass_talk(*talking) : pass_queued();
}

}  // namespace fieldcast::sim

#include "bridge/standby/election.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bridge/base/check.hpp"

namespace fieldcast {
namespace {

bool is_master(StandbyRole role) {
  return role == StandbyRole::kMaster || role == StandbyRole::kHandingOver;
}

// FNV-1a.
std::uint32_t hash_of(std::string_view name) {
  std::uint32_t hash = 2166136261U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash;
}

bool is_better(const StandbyMember& a, const StandbyMember& b) {
  return a.strength != b.strength ? a.strength > b.strength : a.bridge < b.bridge;
}

}  // namespace

Election::Election(StandbyMember own, Instant now) : Election(std::move(own), now, Memory{}) {}

Election::Election(StandbyMember own, Instant now, const Memory& before)
    : own_(std::move(own)),
      others_(before.others_),
      greatest_(before.greatest_),
      master_(before.master_),
      configuration_(before.configuration_),
      alone_since_(now),
      settled_(now + kSettle),
      rejoined_(now + kRejoin),
      looked_(now) {
  own_.role = StandbyRole::kWaiting;
  own_.term = 0;
  // Members of the previous membership count only after a new message.
  for (auto& [name, other] : others_) other.heard = std::min(other.heard, now - kLease);
}

Election::Memory Election::memory() const {
  Memory memory;
  memory.others_ = others_;
  for (auto& [name, other] : memory.others_) other.awaited = alive(other, looked_);
  memory.greatest_ = greatest_;
  memory.master_ = master_;
  memory.configuration_ = configuration_;
  return memory;
}

void Election::receive(const StandbyMember& member, Instant now) {
  if (member.bridge == own_.bridge) return;
  auto [found, is_new] = others_.try_emplace(member.bridge);
  Other& other = found->second;
  if (!is_new) {
    if (member.since == other.before) return;  // a message from before its restart
    if (member.since != other.told.since) {
      other.before = other.told.since;
      if (unheard(other, now) && is_master(own_.role)) count_from(above_unheard(other, now));
    } else if (member.beat <= other.told.beat) {
      return;  // duplicate or late
    }
  }
  other.told = member;
  other.heard = other.told_at = now;
  other.awaited = false;
  other.lost = other.seen_to_end = member.role == StandbyRole::kLeft;
  learn(member.term);
  other.known = greatest_;
  heed(member, now);
}

// Returns a number above every number that the unheard member can have used or received since its
// last message.
//
// Let `known` be the number when both sides of a network cut last received each other. T later, no
// side has a number above known + T / kTermTime + members:
// - Each takeover adds one. M members make at most M + M * T / kSettle takeovers.
// - A member that counts above unheard members starts at this number. Its own `known` is from an
//   instant at which its side was within the bound, and it adds one per kTermTime since, so it
//   stays within the same bound. Repeated restarts of members therefore add nothing.
// A member that starts at this number some time after the last sample of the other side is above
// that side by one for each kTermTime of that time. The minimum of 2 is for a member that took over
// as soon as it could and restarted immediately.
std::uint32_t Election::above_unheard(const Other& other, Instant now) {
  const auto grown = std::max<std::int64_t>(2, (now - other.told_at) / kTermTime);
  return static_cast<std::uint32_t>(
      std::min<std::int64_t>(number_of(other.known) + grown, kMostTerms));
}

// The next term has at least this number; starts one if the present term is lower.
void Election::count_from(std::uint32_t number) {
  if (number_of(greatest_) < number)
    learn(StandbyTerm{std::max(number - 1, number_of(own_.term) + 1)} << 32);
}

void Election::readers_came(Instant now) {
  const bool somebody =
      std::ranges::any_of(others_, [&](const auto& entry) { return unheard(entry.second, now); });
  if (somebody) readers_came_ = std::min(readers_came_, now);
}

// A member that is received again reports its term itself.
void Election::heed_readers(Instant now) {
  if (readers_came_ == kNever || now - readers_came_ < kReturn || now < doubt_until_) return;
  std::uint32_t number = 0;
  for (const auto& [name, other] : others_) {
    if (unheard(other, now)) number = std::max(number, above_unheard(other, now));
  }
  if (number == 0 || heard_master(now) != nullptr) readers_came_ = kNever;
  if (readers_came_ == kNever || own_.role != StandbyRole::kMaster) return;
  if (now < next_for_readers_) return;
  readers_came_ = kNever;
  next_for_readers_ = now + kForReaders;
  count_from(std::max(number, number_of(greatest_) + 1));
}

void Election::follows(std::uint64_t sequence) {
  const auto number = static_cast<std::uint32_t>(sequence >> 32) + 1;  // inverse of sequences_of()
  if (sequence == 0 || own_.role != StandbyRole::kMaster || number < number_of(own_.term)) return;
  learn(StandbyTerm{number} << 32);
  take_over();
}

// Stores a greater term. Two different terms with one number come from members that did not receive
// each other; their samples have the same numbers. The member that continues uses a later term.
void Election::learn(StandbyTerm term) {
  const bool same = number_of(term) == number_of(greatest_) && term != greatest_;
  const bool both =
      static_cast<std::uint32_t>(term) != 0 && static_cast<std::uint32_t>(greatest_) != 0;
  if (same && both) term = StandbyTerm{number_of(term) + 1} << 32;
  greatest_ = std::max(greatest_, term);
}

// Handles a message that changes the role of this member.
void Election::heed(const StandbyMember& other, Instant now) {
  if (is_master(other.role)) {
    alone_since_ = now;
    master_ = other.bridge;
    configuration_ = other.configuration;
    if (own_.role != StandbyRole::kWaiting && other.term > own_.term) step_back();
  }
  const bool asked = other.role == StandbyRole::kReleased && other.successor == own_.bridge;
  if (asked && own_.role == StandbyRole::kWaiting && other.term == greatest_ &&
      not_ready(now).empty())
    take_over();
}

void Election::lost(std::string_view bridge, Instant now) {
  const auto found = others_.find(bridge);
  if (found == others_.end() || found->second.lost) return;
  found->second.lost = true;
  found->second.awaited = false;
  found->second.seen_to_end = now - found->second.told_at < kLease;
}

std::optional<std::string> Election::hand_over(std::string_view successor, Instant now) {
  if (own_.role != StandbyRole::kMaster)
    return fmt::format("{} is {}, not master", own_.bridge, to_text(own_.role));
  if (successor == own_.bridge) return fmt::format("{} is master already", own_.bridge);
  const Other* to = best_of_others(now);
  if (!successor.empty()) {
    const auto found = others_.find(successor);
    if (found == others_.end() || !alive(found->second, now))
      return fmt::format("{} is not there", successor);
    to = &found->second;
    if (!to->told.not_ready.empty())
      return fmt::format("{} is not ready: {}", successor, to->told.not_ready);
  }
  if (to == nullptr) return "nobody else is ready";
  own_.role = StandbyRole::kHandingOver;
  own_.successor = to->told.bridge;
  return std::nullopt;
}

void Election::released(Instant now) {
  if (own_.role != StandbyRole::kHandingOver) return;
  own_.role = StandbyRole::kReleased;
  released_at_ = now;
}

void Election::step_back() {
  own_.role = StandbyRole::kWaiting;
  own_.successor.clear();
  released_at_ = kNever;
  doubt_until_ = kLongAgo;
}

void Election::take_over() {
  own_.role = StandbyRole::kMaster;
  own_.successor.clear();
  own_.term = ((greatest_ >> 32) + 1) << 32 | hash_of(own_.bridge);
  greatest_ = own_.term;
  doubt_until_ = kLongAgo;
  master_.clear();  // its own channels are those of the group
}

void Election::on_time(Instant now) {
  const Duration unseen = now - std::exchange(looked_, now);
  if (unseen >= kDoubt) {
    // Messages that arrived while this process was stopped have not been read yet.
    doubt_until_ = now + kListen;
    for (auto& [name, other] : others_) {
      if (!other.lost) other.heard = std::max(other.heard, now - kLease + kListen);
    }
  }
  if (own_.role == StandbyRole::kReleased && now - released_at_ >= kHandOver) {
    step_back();
    alone_since_ = now - kLease;
  }
  heed_readers(now);
  const bool in_doubt = now < doubt_until_;  // first listens
  if (own_.role == StandbyRole::kMaster && greatest_ > own_.term && !in_doubt) take_over();
  if (own_.role == StandbyRole::kHandingOver && !is_alive(own_.successor, now)) {
    own_.role = StandbyRole::kMaster;  // the successor was lost
    own_.successor.clear();
  }
  if (own_.role == StandbyRole::kWaiting) consider(now);
}

void Election::consider(Instant now) {
  if (!not_ready(now).empty()) {
    ready_since_ = kNever;
  } else if (ready_since_ == kNever) {
    ready_since_ = now;
  }
  if (heard_master(now) != nullptr) {
    alone_since_ = now;
    return;
  }
  if (now < settled_ || now < doubt_until_ || ready_since_ == kNever) return;
  const auto is_awaited = [](const auto& entry) { return entry.second.awaited; };
  if (now < rejoined_ && std::ranges::any_of(others_, is_awaited)) return;
  // Others may have become ready at the same time and must be received first.
  const bool alone =
      std::ranges::none_of(others_, [&](const auto& entry) { return alive(entry.second, now); });
  if (!alone && now - ready_since_ < kListen) return;
  // Better members take over first; each has kPatience for it.
  const Instant begun = std::max({alone_since_, settled_, ready_since_});
  if (const int better = better_ones(now); better > 0 && now - begun < better * kPatience) return;
  take_over();
}

// Includes a released master while its successor has time to take over.
const Election::Other* Election::heard_master(Instant now) const {
  const Other* found = nullptr;
  for (const auto& [name, other] : others_) {
    if (!alive(other, now)) continue;
    if (!is_master(other.told.role) && other.told.role != StandbyRole::kReleased) continue;
    if (other.told.role == StandbyRole::kReleased && other.told.successor == own_.bridge &&
        !not_ready_.empty())
      continue;
    if (found == nullptr || other.told.term > found->told.term) found = &other;
  }
  return found;
}

const Election::Other* Election::best_of_others(Instant now) const {
  const Other* best = nullptr;
  for (const auto& [name, other] : others_) {
    if (!alive(other, now) || !other.told.not_ready.empty()) continue;
    if (other.told.role != StandbyRole::kWaiting) continue;
    if (other.told.configuration != own_.configuration) continue;
    if (best == nullptr || is_better(other.told, best->told)) best = &other;
  }
  return best;
}

int Election::better_ones(Instant now) const {
  return static_cast<int>(std::ranges::count_if(others_, [&](const auto& entry) {
    const Other& other = entry.second;
    return alive(other, now) && other.told.role == StandbyRole::kWaiting &&
           other.told.not_ready.empty() && is_better(other.told, own_);
  }));
}

Instant Election::serves_until() const {
  const bool master = is_master(own_.role);
  return master && looked_ >= doubt_until_ ? looked_ + kDoubt : kLongAgo;
}

bool Election::serves(Instant now) const { return now < serves_until(); }

StandbyMember Election::beat() {
  ++own_.beat;
  StandbyMember told = own_;
  if (!is_master(own_.role) && own_.role != StandbyRole::kReleased) told.term = greatest_;
  // A master in doubt does not announce itself as master.
  if (is_master(own_.role) && looked_ < doubt_until_) told.role = StandbyRole::kWaiting;
  told.not_ready = not_ready(looked_);
  return told;
}

std::optional<std::string> Election::master(Instant now) const {
  if (is_master(own_.role)) return own_.bridge;
  const Other* const other = heard_master(now);
  return other == nullptr ? std::nullopt : std::optional(other->told.bridge);
}

bool Election::is_alive(std::string_view bridge, Instant now) const {
  const auto found = others_.find(bridge);
  return found != others_.end() && alive(found->second, now);
}

std::string Election::not_ready(Instant now) const {
  if (!not_ready_.empty() || is_master(own_.role)) return not_ready_;
  if (master_.empty() || configuration_ == own_.configuration) return {};
  return fmt::format("its channels differ from those of the {}master {}",
                     heard_master(now) == nullptr ? "last " : "", master_);
}

}  // namespace fieldcast

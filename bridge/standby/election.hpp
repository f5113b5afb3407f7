// Which bridge of a standby group is its master: one state machine for each member, fed with the
// messages of the others and with the time. Pure: no thread, no clock, no DDS; one owner.
//
// The rules:
// - Who hears no master for kLease takes over, if it is ready and no better member is: the
//   strongest, then the one whose name comes first.
// - A master stays master, whoever comes later. It hands over when it is asked to.
// - Each mastership has a term. A later one has a greater term, and no two members ever have the
//   same. Of two masters that hear each other the one with the smaller term steps back at once.
// - A master takes a later term where another one may have been master meanwhile: who was heard
//   knows of a later term, or of another one of the same number, or has begun anew after nobody
//   heard it for a while; and where readers come, or ask for what they lack, while a member is out
//   of sight: they may have followed that one. So does who takes over, and follows samples that
//   count above its term.
// - A master that had no time for kDoubt, because its process was stopped or its machine stood
//   still, serves nothing until it has listened again: another one may have taken over.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

enum class StandbyRole : std::uint8_t {
  kWaiting,
  kMaster,
  kHandingOver,  // serves until it is released
  kReleased,     // serves no longer, its successor is to take over
  kLeft,         // is no member any more
};
[[nodiscard]] constexpr std::string_view to_text(StandbyRole role) {
  switch (role) {
    case StandbyRole::kWaiting: return "waiting";
    case StandbyRole::kMaster: return "master";
    case StandbyRole::kHandingOver: return "handing over";
    case StandbyRole::kReleased: return "released";
    case StandbyRole::kLeft: return "left";
  }
  return "unknown";
}

// The counter in the upper half, a hash of the member's name in the lower one: members that cannot
// hear each other choose different terms.
using StandbyTerm = std::uint64_t;
[[nodiscard]] constexpr std::uint32_t number_of(StandbyTerm term) {  // for people
  return static_cast<std::uint32_t>(term >> 32);
}
// The samples of a term count from above this number: those of a later term have greater numbers
// than all before, whatever the new master knows of them. Of 2^32 samples of a channel for each
// number of a term; below 2^63, as databases want it.
inline constexpr std::uint32_t kMostTerms = 0x7fffffff;
[[nodiscard]] constexpr std::uint64_t sequences_of(StandbyTerm term) {
  const std::uint32_t number = number_of(term);
  return std::uint64_t{number == 0 ? 0 : (number <= kMostTerms ? number : kMostTerms) - 1} << 32;
}

// What a member tells the others.
struct StandbyMember {
  std::string bridge;      // its name, unique in the group
  std::int64_t since = 0;  // when it joined; another one after a restart
  std::uint64_t beat = 0;  // counts its messages since then
  std::int32_t strength = 0;
  StandbyRole role = StandbyRole::kWaiting;
  StandbyTerm term = 0;       // as master; else the greatest that it knows of
  std::string successor;      // of kHandingOver and kReleased
  std::string configuration;  // what all members must have in common
  std::string not_ready;      // why it does not take over; empty: it is ready
  friend bool operator==(const StandbyMember&, const StandbyMember&) = default;
};

class Election {
 private:
  struct Other {
    StandbyMember told;
    Instant heard;    // as if at the end of a time in which this process stood still
    Instant told_at;  // really
    bool lost = false;
    bool seen_to_end = false;  // it was heard up to its end
    std::int64_t before = 0;   // `since` of its life before this one
    StandbyTerm known = 0;     // the greatest one, when it was heard
  };
  using Others = std::map<std::string, Other, std::less<>>;

 public:
  // What a member that begins anew in the same process goes on knowing: the terms of the group, and
  // who was in it.
  class Memory {
    friend class Election;
    Others others_;
    StandbyTerm greatest_ = 0;
    std::string master_, configuration_;  // the last master, and its channels
  };

  static constexpr Duration kTick = std::chrono::milliseconds{25};
  static constexpr Duration kBeat = std::chrono::milliseconds{100};   // between two messages
  static constexpr Duration kLease = std::chrono::milliseconds{300};  // without one: it is gone
  // Shorter than the lease: who was silent for so long may have been replaced.
  static constexpr Duration kDoubt = std::chrono::milliseconds{220};
  // How long a master in doubt listens, and one of several that has just become ready: others beat
  // meanwhile.
  static constexpr Duration kListen = std::chrono::milliseconds{150};
  // How long others have to be found at the start.
  static constexpr Duration kSettle = std::chrono::seconds{1};
  // A better member that does not take over is waited for so long.
  static constexpr Duration kPatience = std::chrono::seconds{1};
  // A successor has so long to take over, then anybody may.
  static constexpr Duration kHandOver = std::chrono::seconds{1};
  // Members that are out of sight count one number in this time, at most: a member takes over once
  // in kSettle, and groups have up to kSettle / kTermTime members. What is counted above them goes
  // as far as they may have come, and no further: above_unheard().
  static constexpr Duration kTermTime = std::chrono::milliseconds{250};
  // Who was cut off together with a reader is heard again within this time. It is also what a term
  // for readers is ahead of those that they may have followed: 16 numbers.
  static constexpr Duration kReturn = std::chrono::seconds{4};
  // Between two terms that are taken for readers.
  static constexpr Duration kForReaders = std::chrono::seconds{10};

  // `own`: name, since, strength, configuration.
  Election(StandbyMember own, Instant now);
  Election(StandbyMember own, Instant now, const Memory& before);
  [[nodiscard]] Memory memory() const;

  // ---- what happens

  void receive(const StandbyMember& member, Instant now);
  // Its process is gone, or it has left: at once, without its lease.
  void lost(std::string_view bridge, Instant now);
  // Why this member cannot take over; empty: it can. A master stays one.
  void set_not_ready(std::string reason) { not_ready_ = std::move(reason); }
  void set_configuration(std::string configuration) {
    own_.configuration = std::move(configuration);
  }
  // Somebody wants `successor` to be master; empty: the best of the others. Nothing: it begins.
  // Else why it does not. REQUIRES: asked at the master.
  [[nodiscard]] std::optional<std::string> hand_over(std::string_view successor, Instant now);
  // The buses are let go of, after kHandingOver.
  void released(Instant now);
  // Readers of samples have come, or ask for what they lack: they may have been where another one
  // was master, and ignore samples that count below those of that one.
  void readers_came(Instant now);
  // The samples that a new master has followed count up to here. It takes a later term where that
  // is above its own: their master was not heard itself.
  void follows(std::uint64_t sequence);
  // Every kTick or sooner. When kBeat has passed, or the role is another one, beat() is to be sent.
  void on_time(Instant now);

  // ---- what follows

  [[nodiscard]] StandbyRole role() const { return own_.role; }
  // The buses are this bridge's now: checked before every request and every sample that leaves.
  [[nodiscard]] bool serves(Instant now) const;
  // Until when it serves without another on_time(); kLongAgo: not at all.
  [[nodiscard]] Instant serves_until() const;
  [[nodiscard]] StandbyTerm term() const { return own_.term; }
  [[nodiscard]] StandbyMember beat();  // what the others are told now
  // The live master; nothing: none is heard. This member itself, too.
  [[nodiscard]] std::optional<std::string> master(Instant now) const;
  [[nodiscard]] bool is_alive(std::string_view bridge, Instant now) const;
  [[nodiscard]] std::string not_ready(Instant now) const;  // as the others are told

 private:
  // Out of sight it may be alive, and master.
  [[nodiscard]] static bool unheard(const Other& other, Instant now) {
    return !other.seen_to_end && now - other.told_at >= kLease;
  }
  [[nodiscard]] static std::uint32_t above_unheard(const Other& other, Instant now);
  void count_from(std::uint32_t number);
  [[nodiscard]] bool alive(const Other& other, Instant now) const {
    return !other.lost && now - other.heard < kLease;
  }
  [[nodiscard]] const Other* heard_master(Instant now) const;
  [[nodiscard]] const Other* best_of_others(Instant now) const;
  [[nodiscard]] int better_ones(Instant now) const;
  void consider(Instant now);
  void take_over();
  void step_back();
  void heed(const StandbyMember& other, Instant now);
  void learn(StandbyTerm term);
  void heed_readers(Instant now);

  StandbyMember own_;
  std::string not_ready_ = "it has just begun";
  Others others_;
  StandbyTerm greatest_ = 0;            // heard of, or had
  std::string master_, configuration_;  // the last master that was heard, and its channels
  Instant alone_since_;                 // no master heard since then
  Instant settled_;                     // others could be found until then
  Instant ready_since_ = kNever;
  Instant looked_;  // the last on_time()
  Instant doubt_until_ = kLongAgo;
  Instant released_at_ = kNever;
  Instant readers_came_ = kNever;        // and nothing has been done about it
  Instant next_for_readers_ = kLongAgo;  // no term is taken for them before
};

}  // namespace fieldcast

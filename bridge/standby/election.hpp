// Elects the master of a standby group. Each member runs one such state machine; its inputs are the
// messages of the others and the time. Pure: no thread, no clock, no DDS; one owner.
//
// Rules:
// - A member that receives no master for kLease takes over if it is ready and no better member is.
//   Better is the greater strength, then the name that sorts first.
// - A master stays master when better members join. It hands over on request.
// - Each mastership has a term. A later one has a greater term, and no two members have the same
//   term. Of two masters that receive each other, the one with the smaller term steps back
//   immediately.
// - A master starts a later term if another member may have been master meanwhile. It does so if a
//   member reports a later term, reports a different term with the same number, or restarted after
//   a time without messages. It also does so if readers match or request missing samples while a
//   member is unheard, because these readers may have followed that member. A new master does so if
//   it follows samples with numbers above its term.
// - A master whose process did not run for kDoubt (stopped, or the machine paused) serves nothing
//   until it has listened: another member may have taken over.
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
  kHandingOver,  // serves until released() is called
  kReleased,     // no longer serves; its successor takes over
  kLeft,         // no longer a member
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

// Upper half: a counter; lower half: a hash of the name, so that cut-off members differ.
using StandbyTerm = std::uint64_t;
[[nodiscard]] constexpr std::uint32_t number_of(StandbyTerm term) {  // human-readable
  return static_cast<std::uint32_t>(term >> 32);
}
// Sample numbers of a term start above this, so they exceed those of all earlier terms. Each term
// number has 2^32 samples per channel; the result is below 2^63, which databases require.
inline constexpr std::uint32_t kMostTerms = 0x7fffffff;
[[nodiscard]] constexpr std::uint64_t sequences_of(StandbyTerm term) {
  const std::uint32_t number = number_of(term);
  return std::uint64_t{number == 0 ? 0 : (number <= kMostTerms ? number : kMostTerms) - 1} << 32;
}

struct StandbyMember {
  std::string bridge;      // unique in the group
  std::int64_t since = 0;  // time of joining; differs after a restart
  std::uint64_t beat = 0;  // counts its messages since then
  std::int32_t strength = 0;
  StandbyRole role = StandbyRole::kWaiting;
  StandbyTerm term = 0;       // of a master; otherwise the greatest known
  std::string successor;      // of kHandingOver and kReleased
  std::string configuration;  // must be the same for all members
  std::string not_ready;      // why it does not take over; empty: ready
  friend bool operator==(const StandbyMember&, const StandbyMember&) = default;
};

class Election {
 private:
  struct Other {
    StandbyMember told;
    Instant heard;    // time of the last message; later if this process was stopped since
    Instant told_at;  // true time of the last message
    bool lost = false;
    bool seen_to_end = false;  // its messages were received until its end
    bool awaited = false;      // was alive when this member left to rejoin, not received since
    std::int64_t before = 0;   // `since` before its restart
    StandbyTerm known = 0;     // greatest known term at its last message
  };
  using Others = std::map<std::string, Other, std::less<>>;

 public:
  // Terms and members of the group, for a member that rejoins in the same process.
  class Memory {
    friend class Election;
    Others others_;
    StandbyTerm greatest_ = 0;
    std::string master_, configuration_;  // the last master and its channels
  };

  static constexpr Duration kTick = std::chrono::milliseconds{25};
  static constexpr Duration kBeat = std::chrono::milliseconds{100};  // between two messages
  // Without a message, a member counts as lost.
  static constexpr Duration kLease = std::chrono::milliseconds{300};
  // Shorter than the lease: a member that was silent this long may have been replaced.
  static constexpr Duration kDoubt = std::chrono::milliseconds{220};
  // Listening time of a master in doubt, and of a member that just became ready.
  static constexpr Duration kListen = std::chrono::milliseconds{150};
  // Time at the start to discover other members.
  static constexpr Duration kSettle = std::chrono::seconds{1};
  // Time at a rejoin to receive those that were alive before it again. With DDS Security, a lost
  // datagram of a handshake is repeated only after seconds.
  static constexpr Duration kRejoin = std::chrono::seconds{10};
  // Time that a better member has to take over.
  static constexpr Duration kPatience = std::chrono::seconds{1};
  // Time that a successor has to take over; then any member may.
  static constexpr Duration kHandOver = std::chrono::seconds{1};
  // Unheard members use at most one number per this time. A member takes over at most once per
  // kSettle, and a group has up to kSettle / kTermTime members. See above_unheard() for the bound.
  static constexpr Duration kTermTime = std::chrono::milliseconds{250};
  // Within this time, a member that was cut off together with a reader is received again. A term
  // started for readers is 16 numbers ahead of the terms that they may have followed; that is this
  // time as well.
  static constexpr Duration kReturn = std::chrono::seconds{4};
  // Minimum time between two terms started for readers.
  static constexpr Duration kForReaders = std::chrono::seconds{10};

  // `own`: name, since, strength, configuration.
  Election(StandbyMember own, Instant now);
  Election(StandbyMember own, Instant now, const Memory& before);
  [[nodiscard]] Memory memory() const;

  // ---- inputs

  void receive(const StandbyMember& member, Instant now);
  // Its process ended or it left: counts immediately, without waiting for its lease.
  void lost(std::string_view bridge, Instant now);
  // Reason why this member cannot take over; empty: it can. A master stays master.
  void set_not_ready(std::string reason) { not_ready_ = std::move(reason); }
  void set_configuration(std::string configuration) {
    own_.configuration = std::move(configuration);
  }
  // Requests a handover to `successor`, or to the best of the others if empty. Returns
  // `std::nullopt` if it begins, otherwise the reason. REQUIRES: this member is the master.
  [[nodiscard]] std::optional<std::string> hand_over(std::string_view successor, Instant now);
  // The buses were released, after kHandingOver.
  void released(Instant now);
  // Readers of samples have matched or requested missing samples. They may have followed another
  // master and then ignore samples with lower numbers.
  void readers_came(Instant now);
  // Greatest number of the samples that a new master has followed. If it is above the new master's
  // term, their master was never received itself, and a later term begins.
  void follows(std::uint64_t sequence);
  // To be called every kTick or sooner. Send beat() when kBeat has passed or the role has changed.
  void on_time(Instant now);

  // ---- state

  [[nodiscard]] StandbyRole role() const { return own_.role; }
  // Returns true if the buses belong to this bridge. Check before each request and sample.
  [[nodiscard]] bool serves(Instant now) const;
  // End of the time that it serves without another on_time(); kLongAgo: it does not serve.
  [[nodiscard]] Instant serves_until() const;
  [[nodiscard]] StandbyTerm term() const { return own_.term; }
  [[nodiscard]] StandbyMember beat();  // next message to the others
  // Returns the live master, which may be this member; `std::nullopt` if none is received.
  [[nodiscard]] std::optional<std::string> master(Instant now) const;
  [[nodiscard]] bool is_alive(std::string_view bridge, Instant now) const;
  [[nodiscard]] std::string not_ready(Instant now) const;  // as announced

 private:
  // The member may be alive, and master, although no message arrives.
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
  StandbyTerm greatest_ = 0;            // greatest term received or used
  std::string master_, configuration_;  // last received master and its channels
  Instant alone_since_;                 // time of the last message of a master
  Instant settled_;                     // end of the time to discover others
  Instant rejoined_;                    // end of the time to receive awaited members again
  Instant ready_since_ = kNever;
  Instant looked_;
  Instant doubt_until_ = kLongAgo;
  Instant released_at_ = kNever;
  Instant readers_came_ = kNever;        // not handled yet
  Instant next_for_readers_ = kLongAgo;  // earliest time of the next term for readers
};

}  // namespace fieldcast

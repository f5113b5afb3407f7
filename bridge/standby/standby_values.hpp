// Set of the commands of the last seconds, in a standby group. The router stores commands with a
// response of another bridge, the group stores writes that another bridge has begun: such a command
// may still be in flight to this bridge and must not run. The bridge stores commands that have
// their result, for members that hold them. Pure; the owner guards it. A full set drops the oldest
// entry.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bridge/standby/election.hpp"
#include "core/alarm/alarm_registry.hpp"
#include "core/base/time.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class RecentCommands {
 public:
  // Longest time that DDS needs to deliver a command; a reader that is away longer is dropped.
  static constexpr Duration kFor = std::chrono::seconds{10};
  static constexpr std::size_t kMost = 4096;
  using Key = std::pair<std::string, std::uint64_t>;

  RecentCommands() = default;
  explicit RecentCommands(Duration kept) : kept_(kept) {}

  void note(const Key& key, Instant now) {
    forget(now);
    if (!keys_.insert(key).second) return;
    order_.emplace_back(key, now);
  }
  void remove(const Key& key) {
    if (keys_.erase(key) > 0) std::erase_if(order_, [&](const auto& e) { return e.first == key; });
  }
  [[nodiscard]] bool lately(const Key& key, Instant now) {
    forget(now);
    return keys_.contains(key);
  }

 private:
  void forget(Instant now) {
    while (!order_.empty() && (order_.front().second + kept_ <= now || order_.size() >= kMost)) {
      keys_.erase(order_.front().first);
      order_.pop_front();
    }
  }

  Duration kept_ = kFor;
  std::set<Key> keys_;
  std::deque<std::pair<Key, Instant>> order_;
};

// Messages between bridges of a standby group, and the state that a member keeps of the data its
// master publishes. Plain values; any thread.
struct StandbyBusFigures {
  std::string bus;
  std::uint64_t epoch = 0;   // of its catalogue
  std::uint64_t blocks = 0;  // number of the last SampleBlock, written or followed
  friend bool operator==(const StandbyBusFigures&, const StandbyBusFigures&) = default;
};

struct StandbyMessage {
  std::string group;
  StandbyMember member;
  std::string host, process;
  std::uint64_t written = 0;  // by the master: number of its last note
  std::uint64_t noted = 0;    // by other members: last note of the term that they have
  std::vector<StandbyBusFigures> buses;
};

enum class StandbyNoteKind : std::uint8_t {
  kBegun,      // from now on the command may have an effect
  kReturned,   // it had no effect, and the successor must run it
  kCompleted,  // it has its result; sent to a member that holds it without knowledge of the result
};
struct StandbyNote {
  std::string group, bridge;
  // 0: sent by a member that holds the command without a result, not by the master. kBegun then
  // means that a master had begun it; kReturned that none has, as far as the member knows.
  StandbyTerm term = 0;
  std::uint64_t number = 0;  // 0: not one that all members must have
  StandbyNoteKind kind = StandbyNoteKind::kBegun;
  std::string bus;
  std::string requester;
  std::uint64_t request_id = 0;
};

// A request for a change of master.
struct StandbyRequest {
  std::string group;
  std::string bridge;  // empty: any ready member
  std::string by;
};

// State that a member keeps of a bus served by another bridge.
struct FollowedBus {
  std::uint64_t epoch = 0;  // 0: nothing received yet
  std::uint64_t blocks = 0;
  BusInheritance state;
};

}  // namespace fieldcast

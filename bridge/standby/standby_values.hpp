// Messages between bridges of a standby group, and the state that a member keeps of the data its
// master publishes. Plain values; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/standby/election.hpp"
#include "core/alarm/alarm_registry.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

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
  kBegun,     // from now on the command may have an effect
  kReturned,  // it had no effect, and the successor must run it
  kAnswered,  // it has its result; sent to a member that holds it without knowledge of the result
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

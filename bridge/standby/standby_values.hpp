// What bridges of a standby group tell each other, and what a member keeps of what its master
// publishes. Plain values; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/standby/election.hpp"
#include "core/alarm/alarm_book.hpp"
#include "core/model/inheritance.hpp"

namespace fieldcast {

struct StandbyBusFigures {
  std::string bus;
  std::uint64_t epoch = 0;   // of its catalogue
  std::uint64_t blocks = 0;  // the number of the last SampleBlock: written, or followed
  friend bool operator==(const StandbyBusFigures&, const StandbyBusFigures&) = default;
};

struct StandbyMessage {
  std::string group;
  StandbyMember member;
  std::string host, process;
  std::uint64_t written = 0;  // by the master: number of its last note
  std::uint64_t noted = 0;    // by the others: up to which they have the notes of the term
  std::vector<StandbyBusFigures> buses;
};

enum class StandbyNoteKind : std::uint8_t {
  kBegun,     // from here on the command may have an effect
  kReturned,  // it had none, and the successor is to run it
  kAnswered,  // it has its result: told to a member that holds it and has not heard that
};
struct StandbyNote {
  std::string group, bridge;
  // 0: not by the master, but by a member that holds the command and hears no result. kBegun then
  // means that a master had begun it, kReturned that none has, as far as this member knows.
  StandbyTerm term = 0;
  std::uint64_t number = 0;  // 0: not of those that all members must have
  StandbyNoteKind kind = StandbyNoteKind::kBegun;
  std::string bus;
  std::string requester;
  std::uint64_t request_id = 0;
};

// Somebody wants another master.
struct StandbyRequest {
  std::string group;
  std::string bridge;  // empty: whichever is ready
  std::string by;
};

// What a member knows of a bus that another one serves.
struct FollowedBus {
  std::uint64_t epoch = 0;   // 0: nothing came yet
  std::uint64_t blocks = 0;  // number of the last one
  BusInheritance state;
};

}  // namespace fieldcast

// Detects restarts of discovery servers from the messages that they send. Any thread.
//
// A restarted server of Fast DDS 2.9.1 has the same GUID and numbers its messages from 1 again. A
// participant treats them as old ones (WriterProxy::process_heartbeat,
// StatefulWriter::process_acknack) until the numbers exceed the earlier ones, which may take
// forever. This class detects numbers that start again, and returns a message, like that of a
// server that leaves, which makes the library remove the server and join it again immediately. The
// same is done if no message of a server arrived for kSilence: a server sends every 2 s, and has
// removed a participant that was disconnected for so long, but the library would keep the server
// for 20 s.
//
// A server that has removed this participant has announced that to the others, which have removed
// its endpoints and start again. This participant received no such message and keeps outdated
// state. That the server starts again is visible in its acknowledgements of our endpoints. Then the
// library also receives the end of each participant that was silent until then; the server
// announces those that are present. Participants that were heard all the time have not lost this
// one: then the server was disconnected, not this participant.
//
// Only a server that had discovered a participant announces its end. A participant that was neither
// heard nor announced by a server within kAbsence after the server's restart is removed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "bridge/dds/guard/parameter_list.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class ServerRestarts {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr unsigned kMostServers = 256;  // their identity is one byte
  // A message is never delayed by more, so a lower number after this time is not an old message.
  static constexpr Duration kLongestDelay = std::chrono::seconds{1};
  // Shorter than our lease at a server (10 s) by the time of our own announcements (3 s).
  static constexpr Duration kSilence = std::chrono::seconds{7};
  // Within this time after participants are heard again, the server starts again with them.
  static constexpr Duration kReturn = std::chrono::seconds{3};
  // A running participant joins again within seconds; one disconnected for its lease needs longer.
  static constexpr Duration kAbsence = std::chrono::seconds{20};
  // Participants that are tracked; and participants whose end is reported in one message.
  static constexpr std::size_t kMostOthers = 4096, kMostEnds = 500;

  // The library has discovered the server with this identity, or has removed it.
  void on_server(unsigned identity, bool here);
  // The same for a participant that is not a server. Also called for repeated announcements.
  void on_other(const ParticipantPrefix& prefix, bool here);

  // Call it for each message from the network, before the library reads it. The library must read a
  // result that is not empty first. Empty for servers that the library has not discovered.
  [[nodiscard]] Bytes goodbye_before(std::span<const std::uint8_t> message, Instant now);

  struct Announcement {  // of a participant, by the server
    std::uint64_t number = 0;
    std::uint64_t stamp = 0;  // when the server numbered it; grows with the number
  };
  struct Heartbeat {
    std::uint64_t last = 0;  // highest number that the server has now; earlier ones may be higher
    std::uint64_t count = 0;
  };
  struct Acknowledgement {  // of our announcements of writers, or of readers
    bool of_writers = false;
    std::uint64_t base = 0;  // 0: the server has just started to read it
    std::uint64_t count = 0;
  };

 private:
  struct Server {
    bool here = false;
    Announcement announcement;  // the one with the highest number
    Heartbeat highest;          // each member is the highest of all heartbeats
    std::uint64_t settled = 0;  // highest count at least kLongestDelay ago
    Instant highest_since{};
    Instant heard = kNever;
    // Highest count since the server started to read; 0 before that. Index 0: readers, 1: writers.
    std::array<std::uint64_t, 2> acknowledged{};
    bool begins_anew = false;  // with this participant, and not yet reported to the library
    Instant anew = kNever;     // time of the last start again, with this participant or with all
  };
  struct Other {
    Instant heard;
    Instant announced;            // by a server
    Instant returned = kLongAgo;  // first message after a silence
  };
  // Returns true if the message is from a restarted server.
  static bool is_another(Server& server, const Announcement& announcement);
  static bool is_another(Server& server, const Heartbeat& heartbeat, Instant now);
  static bool begins_anew(Server& server, const Acknowledgement& one);
  // REQUIRES for all: mutex_ held.
  void heard(const ParticipantPrefix& prefix, Instant now);
  [[nodiscard]] std::vector<ParticipantPrefix> silent_ones(Instant now) const;
  [[nodiscard]] std::vector<ParticipantPrefix> absent_ones(const Server& server, Instant now) const;

  std::mutex mutex_;
  std::array<Server, kMostServers> servers_{};  // by identity
  std::map<ParticipantPrefix, Other> others_;   // at most kMostOthers
  Instant latest_{};                            // time of the last message
};

}  // namespace fieldcast

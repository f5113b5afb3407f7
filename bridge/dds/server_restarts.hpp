// Discovery servers that start anew, recognised by what they send.
//
// A server of Fast DDS 2.9.1 has the same GUID after a restart, and numbers its messages from 1
// again. A participant takes them for old ones (WriterProxy::process_heartbeat,
// StatefulWriter::process_acknack), and learns nothing from the server until the numbers have grown
// beyond those of before, which may take for ever. It would begin anew with a server that it has
// given up, but that needs 20 s without a message of the server.
//
// Here a restart is recognised by numbers that begin anew, and the library is told that the server
// has left, by a message like that of a server that ends. It joins the server again at once.
//
// The same is done where nothing came from a server for kSilence: it sends each 2 s, and has let go
// of who was cut off for so long, while the library would take it for present until 20 s are over,
// and would learn nothing of what the server sent to others meanwhile.
//
// A server that has given this participant up, and takes it back, has told the others of its end:
// they have let go of what they had of it, and begin anew. This participant was told nothing, and
// keeps what it had of them: writers that take what a new reader asks for as acknowledged, readers
// and writers of programs that have ended meanwhile. That the server begins anew is seen by its
// acknowledgements of our endpoints; then the library is told of the end of those, too, that were
// silent until then. The server tells it of those that are there. Those that were heard all the
// time have not lost us: it was the server that was cut off.
//
// The end of a participant is told by a server that knew it, and by no other: who was killed less
// than its lease before the server started anew, or while there was none, would be kept for ever.
// Who was neither heard nor announced by a server for kAbsence since that began anew is let go of.
//
// Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "bridge/dds/participant_note.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class ServerRestarts {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr unsigned kMostServers = 256;  // their identity is one byte
  // A message is not delayed by more, so that a lower number after it is no old one.
  static constexpr Duration kLongestDelay = std::chrono::seconds{1};
  // Shorter than our lease (10 s), for which a server waits, by what we announce ourselves (3 s).
  static constexpr Duration kSilence = std::chrono::seconds{7};
  // So soon after others are heard again, the server begins anew.
  static constexpr Duration kReturn = std::chrono::seconds{3};
  // Who lives joins a server again within seconds; one that was cut off for its lease, later.
  static constexpr Duration kAbsence = std::chrono::seconds{20};
  // Others that are looked after; and of which the end is told at once.
  static constexpr std::size_t kMostOthers = 4096, kMostEnds = 500;

  // What the library knows: the server with this identity is here, or has left.
  void on_server(unsigned identity, bool here);
  // The same of another participant, which is no server. Also when it is announced once more.
  void on_other(const ParticipantPrefix& prefix, bool here);

  // Of a message from the network, before the library reads it. Not empty: a message that the
  // library must read first. A server that the library does not know needs none.
  [[nodiscard]] Bytes goodbye_before(std::span<const std::uint8_t> message, Instant now);

  struct Announcement {  // of a participant, by the server
    std::uint64_t number = 0;
    std::uint64_t stamp = 0;  // when the server numbered it; grows with the number
  };
  struct Heartbeat {
    std::uint64_t last = 0;  // the highest number that the server has; not the highest it had
    std::uint64_t count = 0;
  };
  struct Acknowledgement {  // of what we say of our writers, or of our readers
    bool of_writers = false;
    std::uint64_t base = 0;  // 0: the server has just begun to read it
    std::uint64_t count = 0;
  };

 private:
  struct Server {
    bool here = false;
    Announcement announcement;  // the one with the highest number
    Heartbeat highest;          // each the highest of all
    std::uint64_t settled = 0;  // the highest count, kLongestDelay ago or longer
    Instant highest_since{};
    Instant heard = kNever;  // its last message
    // The highest count since the server reads it; 0: it does not yet. Of readers, of writers.
    std::array<std::uint64_t, 2> acknowledged{};
    bool begins_anew = false;  // with us, and the library was not told
    Instant anew = kNever;     // since when: with us, or with everybody
  };
  struct Other {
    Instant heard;                // its last message
    Instant announced;            // by a server
    Instant returned = kLongAgo;  // when it was heard again after a silence
  };
  // Whether it is of another server than those before.
  static bool is_another(Server& server, const Announcement& announcement);
  static bool is_another(Server& server, const Heartbeat& heartbeat, Instant now);
  static bool begins_anew(Server& server, const Acknowledgement& one);
  // REQUIRES, all: mutex_ held.
  void heard(const ParticipantPrefix& prefix, Instant now);
  [[nodiscard]] std::vector<ParticipantPrefix> silent_ones(Instant now) const;
  [[nodiscard]] std::vector<ParticipantPrefix> absent_ones(const Server& server, Instant now) const;

  std::mutex mutex_;
  std::array<Server, kMostServers> servers_{};  // by identity
  std::map<ParticipantPrefix, Other> others_;   // at most kMostOthers
  Instant latest_{};                            // when the last message came
};

}  // namespace fieldcast

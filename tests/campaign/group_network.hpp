// The network between the members of a standby group and a station, in virtual time: it loses what
// is not repeated (the members' messages of ten times a second), delays everything, and may be cut
// in two. What is reliable waits for a short cut to end; after a long one it is gone, as for a DDS
// reader that was away for longer than its lease.
//
// Deterministic by its seed; one thread; nothing can fail.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "bridge/standby/standby_values.hpp"
#include "core/model/command.hpp"

namespace fieldcast::test {

// What a master publishes of its bus.
struct GroupBlock {
  std::uint64_t epoch = 0, number = 0;
  // Of the master's term, for the checks alone. Who remains master in a later term is a new one:
  // another member may have been master meanwhile.
  Instant began{};
  StandbyTerm term = 0;  // of the master, as members hear it from itself
  bool again = false;    // last values once more
  std::vector<Sample> samples;
  std::map<std::string, DeviceReport> devices;  // empty: not this time
};
// Of the station, which lacks samples.
struct GroupSnapshotRequest {};
using GroupMessage = std::variant<StandbyMessage, StandbyNote, GroupBlock, CommandResult, Command,
                                  GroupSnapshotRequest>;

class GroupNetwork {
 public:
  static constexpr Duration kLongCut = std::chrono::seconds{10};

  // Nodes are members and, as the last one, the station.
  GroupNetwork(std::size_t nodes, std::uint64_t seed);

  double loss = 0;  // of a message; of a reliable one: it is sent again, and comes later
  Duration most_delay = std::chrono::milliseconds{3};

  void send(std::size_t from, std::size_t to, std::shared_ptr<const GroupMessage> message,
            Instant now);
  // Nodes of different sides do not hear each other.
  void cut(std::vector<bool> side, Instant now);
  // True: it was a long cut, and what was said meanwhile is gone.
  bool heal(Instant now);
  [[nodiscard]] bool is_cut() const { return !side_.empty(); }
  [[nodiscard]] bool apart(std::size_t a, std::size_t b) const {
    return is_cut() && side_[a] != side_[b];
  }
  // The process of a node is gone.
  void forget(std::size_t node);

  [[nodiscard]] Instant next_due() const;
  // What has arrived, in order.
  void deliver(Instant now, const std::function<void(std::size_t to, const GroupMessage&)>& take);

 private:
  struct Link {
    struct Message {
      Instant due;
      std::shared_ptr<const GroupMessage> what;
    };
    std::deque<Message> reliable, unreliable;
    std::deque<std::shared_ptr<const GroupMessage>> kept;  // while it is cut
  };
  Link& link(std::size_t from, std::size_t to) { return links_[from * nodes_ + to]; }
  void queue(Link& link, std::shared_ptr<const GroupMessage> message, Instant now);
  [[nodiscard]] double chance() { return std::generate_canonical<double, 53>(random_); }

  const std::size_t nodes_;
  std::mt19937_64 random_;
  std::vector<Link> links_;
  std::vector<bool> side_;  // empty: not cut
  Instant cut_at_{};
};

}  // namespace fieldcast::test

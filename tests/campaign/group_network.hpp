// Simulates the network between the members of a standby group and a station in virtual time. It
// loses unreliable messages (those that members send ten times a second), delays all messages, and
// can be partitioned. Reliable messages wait until a short partition ends; a long one drops them,
// as for a DDS reader that was away for longer than its lease.
//
// Deterministic by its seed; one thread; no function fails.
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

struct GroupBlock {
  std::uint64_t epoch = 0, number = 0;
  // Start of the master's term, only for the checks. A master that remains in a later term counts
  // as a new one, because a different member may have been master meanwhile.
  Instant began{};
  StandbyTerm term = 0;  // of the master, as it reports it to the members
  bool again = false;    // repeats the last values
  std::vector<Sample> samples;
  std::map<std::string, DeviceReport> devices;  // empty: not in this block
};
// Sent by a station that lacks samples.
struct GroupSnapshotRequest {};
using GroupMessage = std::variant<StandbyMessage, StandbyNote, GroupBlock, CommandResult, Command,
                                  GroupSnapshotRequest>;

class GroupNetwork {
 public:
  static constexpr Duration kLongCut = std::chrono::seconds{10};

  // The last node is the station, all others are members.
  GroupNetwork(std::size_t nodes, std::uint64_t seed);

  double loss = 0;  // probability for a message; a lost reliable message is repeated later
  Duration most_delay = std::chrono::milliseconds{3};

  void send(std::size_t from, std::size_t to, std::shared_ptr<const GroupMessage> message,
            Instant now);
  // Nodes of different sides do not receive each other's messages.
  void cut(std::vector<bool> side, Instant now);
  // Returns true after a long partition, which has dropped all messages sent meanwhile.
  bool heal(Instant now);
  [[nodiscard]] bool is_cut() const { return !side_.empty(); }
  [[nodiscard]] bool apart(std::size_t a, std::size_t b) const {
    return is_cut() && side_[a] != side_[b];
  }
  // Drops all messages to a node.
  void forget(std::size_t node);

  [[nodiscard]] Instant next_due() const;
  void deliver(Instant now, const std::function<void(std::size_t to, const GroupMessage&)>& take);

 private:
  struct Link {
    struct Message {
      Instant due;
      std::shared_ptr<const GroupMessage> what;
    };
    std::deque<Message> reliable, unreliable;
    std::deque<std::shared_ptr<const GroupMessage>> kept;  // during a partition
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

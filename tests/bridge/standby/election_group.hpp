// Simulates a standby group in virtual time, with clocks and a network that have faults.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bridge/standby/election.hpp"

namespace fieldcast::election_group {

using namespace std::chrono_literals;

inline constexpr Instant kStart{std::chrono::hours{1}};

inline StandbyMember member(const std::string& name, std::int32_t strength,
                            std::int64_t since = 1) {
  StandbyMember own;
  own.bridge = name;
  own.strength = strength;
  own.since = since;
  own.configuration = "c";
  return own;
}

struct Message {
  Instant at;
  std::size_t to;
  StandbyMember told;
};

class Group {
 public:
  struct Node {
    std::string name;
    std::int32_t strength = 0;
    Duration offset{};  // of its clock
    double rate = 1;    // of its clock
    std::unique_ptr<Election> election;
    Instant next_tick, next_beat;
    Instant stopped_until = kLongAgo;
    std::vector<StandbyMember> waiting;  // messages for a suspended process
    StandbyRole said = StandbyRole::kWaiting;
    std::uint64_t greatest_term = 0;
  };

  explicit Group(std::uint64_t seed) : random_(seed) {}

  std::size_t add(const std::string& name, std::int32_t strength, Duration offset = {},
                  double rate = 1) {
    Node node;
    node.name = name;
    node.strength = strength;
    node.offset = offset;
    node.rate = rate;
    nodes_.push_back(std::move(node));
    restart(nodes_.size() - 1);
    return nodes_.size() - 1;
  }
  void restart(std::size_t index) {
    Node& node = nodes_[index];
    node.election =
        std::make_unique<Election>(member(node.name, node.strength, ++lives_), clock(node));
    node.election->set_not_ready("");
    node.next_tick = node.next_beat = now_;
    node.waiting.clear();
    node.greatest_term = 0;
  }
  void kill(std::size_t index) {
    nodes_[index].election.reset();
    nodes_[index].waiting.clear();
  }
  void stop(std::size_t index, Duration time) { nodes_[index].stopped_until = now_ + time; }
  void part(std::size_t a, std::size_t b) { parted_.insert({std::min(a, b), std::max(a, b)}); }
  void heal() { parted_.clear(); }

  double loss = 0, twice = 0;
  Duration least_delay = 100us, most_delay = 2ms;

  void run(Duration time) {
    const Instant end = now_ + time;
    while (now_ < end) step();
  }
  [[nodiscard]] std::vector<std::string> masters() const {
    std::vector<std::string> found;
    for (const Node& node : nodes_) {
      if (serves(node)) found.push_back(node.name);
    }
    return found;
  }
  [[nodiscard]] Instant clock(const Node& node) const {
    return kStart + node.offset +
           Duration{
               static_cast<std::int64_t>(static_cast<double>((now_ - kStart).count()) * node.rate)};
  }
  Election& of(std::size_t index) { return *nodes_[index].election; }
  Node& node(std::size_t index) { return nodes_[index]; }
  [[nodiscard]] Instant now() const { return now_; }
  std::mt19937_64& random() { return random_; }

  Duration longest_two{};  // longest continuous time with two serving members
  std::string fault;       // violation of an invariant

 private:
  [[nodiscard]] bool serves(const Node& node) const {
    return node.election && now_ >= node.stopped_until && node.election->serves(clock(node));
  }

  void step() {
    now_ += 1ms;
    std::vector<Message> due;
    std::erase_if(messages_, [&](const Message& message) {
      if (message.at > now_) return false;
      due.push_back(message);
      return true;
    });
    for (const Message& message : due) deliver(message);
    for (std::size_t i = 0; i < nodes_.size(); ++i) turn(i);
    look();
  }

  void deliver(const Message& message) {
    Node& node = nodes_[message.to];
    if (!node.election) return;
    if (now_ < node.stopped_until) {
      node.waiting.push_back(message.told);
    } else {
      receive(node, message.told);
    }
  }

  void receive(Node& node, const StandbyMember& told) {
    node.election->receive(told, clock(node));
    if (node.election->role() != node.said) node.next_beat = now_;
  }

  void turn(std::size_t index) {
    Node& node = nodes_[index];
    if (!node.election || now_ < node.stopped_until) return;
    if (now_ >= node.next_tick) {
      node.election->on_time(clock(node));
      node.next_tick = now_ + 25ms;
    }
    // Messages that arrived during the suspension are read slightly later.
    for (const StandbyMember& told : std::exchange(node.waiting, {})) receive(node, told);
    if (now_ >= node.next_beat || node.election->role() != node.said) say(index);
  }

  void say(std::size_t index) {
    Node& node = nodes_[index];
    const StandbyMember told = node.election->beat();
    node.said = node.election->role();
    node.next_beat = now_ + 100ms;
    if (told.role == StandbyRole::kMaster) {
      const auto [owner, is_new] = owner_of_.try_emplace(told.term, node.name);
      if (owner->second != node.name) fault = "two masters of one term";
    }
    if (told.term < node.greatest_term) fault = "a term became smaller";
    node.greatest_term = told.term;
    for (std::size_t to = 0; to < nodes_.size(); ++to) {
      if (to == index || parted_.contains({std::min(to, index), std::max(to, index)})) continue;
      if (chance() < loss) continue;
      const int copies = chance() < twice ? 2 : 1;
      for (int copy = 0; copy < copies; ++copy) messages_.push_back({now_ + delay(), to, told});
    }
  }

  void look() {
    two_ = masters().size() > 1 ? two_ + 1ms : Duration{};
    longest_two = std::max(longest_two, two_);
  }

  double chance() { return std::uniform_real_distribution<>(0, 1)(random_); }
  Duration delay() {
    return Duration{std::uniform_int_distribution<std::int64_t>(least_delay.count(),
                                                                most_delay.count())(random_)};
  }

  std::mt19937_64 random_;
  Instant now_ = kStart;
  std::vector<Node> nodes_;
  std::vector<Message> messages_;
  std::set<std::pair<std::size_t, std::size_t>> parted_;
  std::map<StandbyTerm, std::string> owner_of_;
  std::int64_t lives_ = 0;
  Duration two_{};
};

}  // namespace fieldcast::election_group

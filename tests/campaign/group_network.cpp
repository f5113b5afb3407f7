#include "tests/campaign/group_network.hpp"

#include <algorithm>

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLeastDelay = 100us;
constexpr Duration kSentAgain = 60ms;

}  // namespace

GroupNetwork::GroupNetwork(std::size_t nodes, std::uint64_t seed)
    : nodes_(nodes), random_(seed), links_(nodes * nodes) {}

void GroupNetwork::queue(Link& link, std::shared_ptr<const GroupMessage> message, Instant now) {
  const bool reliable = !std::holds_alternative<StandbyMessage>(*message);
  Instant due = now + kLeastDelay +
                Duration{static_cast<std::int64_t>(
                    chance() * static_cast<double>((most_delay - kLeastDelay).count()))};
  while (chance() < loss) {
    if (!reliable) return;
    due += kSentAgain;
  }
  auto& queue = reliable ? link.reliable : link.unreliable;
  if (reliable && !queue.empty()) due = std::max(due, queue.back().due);
  const auto behind = std::ranges::upper_bound(queue, due, {}, &Link::Message::due);
  queue.insert(behind, {due, std::move(message)});
}

void GroupNetwork::send(std::size_t from, std::size_t to,
                        std::shared_ptr<const GroupMessage> message, Instant now) {
  Link& way = link(from, to);
  if (!apart(from, to)) return queue(way, std::move(message), now);
  if (!std::holds_alternative<StandbyMessage>(*message)) way.kept.push_back(std::move(message));
}

void GroupNetwork::cut(std::vector<bool> side, Instant now) {
  side_ = std::move(side);
  cut_at_ = now;
}

bool GroupNetwork::heal(Instant now) {
  side_.clear();
  const bool long_cut = now - cut_at_ > kLongCut;
  for (Link& way : links_) {
    for (auto& message : std::exchange(way.kept, {})) {
      if (!long_cut) queue(way, std::move(message), now);
    }
  }
  return long_cut;
}

void GroupNetwork::forget(std::size_t node) {
  for (std::size_t from = 0; from < nodes_; ++from) link(from, node) = {};
}

Instant GroupNetwork::next_due() const {
  Instant next = kNever;
  for (const Link& way : links_) {
    if (!way.reliable.empty()) next = std::min(next, way.reliable.front().due);
    if (!way.unreliable.empty()) next = std::min(next, way.unreliable.front().due);
  }
  return next;
}

void GroupNetwork::deliver(Instant now,
                           const std::function<void(std::size_t to, const GroupMessage&)>& take) {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    for (auto* queue : {&links_[i].unreliable, &links_[i].reliable}) {
      while (!queue->empty() && queue->front().due <= now) {
        const auto message = std::move(queue->front().what);
        queue->pop_front();
        take(i % nodes_, *message);
      }
    }
  }
}

}  // namespace fieldcast::test

#include "bridge/port/dial_in_registry.hpp"

#include <utility>

namespace fieldcast {

void DialInRegistry::set_keeper(Keeper keeper) {
  const std::lock_guard lock(mutex_);
  keeper_ = std::move(keeper);
}

DialInRegistry::Id DialInRegistry::expect(const std::string& number) {
  std::unique_lock lock(mutex_);
  const Id id = ++last_;
  entries_[number].expected = id;
  const auto hand_over = keeper_.hand_over;
  lock.unlock();
  if (!hand_over) return id;
  if (auto kept = hand_over(number); kept.socket.valid()) pass_on(number, std::move(kept));
  return id;
}

void DialInRegistry::forget(const std::string& number, Id id) {
  std::unique_lock lock(mutex_);
  const auto found = entries_.find(number);
  if (found == entries_.end() || found->second.expected != id) return;
  ModuleConnection waiting = std::move(found->second.waiting);
  entries_.erase(found);
  lock.unlock();
  if (waiting.socket.valid()) keep(number, std::move(waiting));
}

bool DialInRegistry::expects(const std::string& number) {
  const std::lock_guard lock(mutex_);
  return entries_.contains(number);
}

DialInRegistry::Id DialInRegistry::claim(const std::string& number, Deliver deliver) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[number];
  entry.claimed = ++last_;
  entry.deliver = std::move(deliver);
  if (entry.waiting.socket.valid()) entry.deliver(std::move(entry.waiting));
  return entry.claimed;
}

void DialInRegistry::release(const std::string& number, Id id) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(number);
  if (found != entries_.end() && found->second.claimed == id) found->second.deliver = {};
}

std::optional<ModuleConnection> DialInRegistry::offer(const std::string& number,
                                                      FileDescriptor socket,
                                                      std::shared_ptr<void> presence) {
  std::unique_lock lock(mutex_);
  const std::uint64_t arrival = ++arrivals_;
  lock.unlock();
  return offer(number, ModuleConnection{std::move(socket), arrival, std::move(presence)});
}

std::optional<ModuleConnection> DialInRegistry::offer(const std::string& number,
                                                      ModuleConnection connection) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(number);
  if (found == entries_.end()) return connection;
  Entry& entry = found->second;
  if (connection.arrival < entry.newest) return std::nullopt;
  entry.newest = connection.arrival;
  if (entry.deliver) {
    entry.deliver(std::move(connection));
  } else {
    entry.waiting = std::move(connection);
  }
  return std::nullopt;
}

void DialInRegistry::pass_on(const std::string& number, ModuleConnection connection) {
  if (auto ours = offer(number, std::move(connection))) keep(number, std::move(*ours));
}

void DialInRegistry::keep(const std::string& number, ModuleConnection connection) {
  std::unique_lock lock(mutex_);
  const auto keep = keeper_.keep;
  lock.unlock();
  if (keep) keep(number, std::move(connection));
}

}  // namespace fieldcast

#include "bridge/port/dial_in_registry.hpp"

namespace fieldcast {

void DialInRegistry::expect(const std::string& number) {
  const std::lock_guard lock(mutex_);
  entries_[number];
}

void DialInRegistry::forget(const std::string& number) {
  const std::lock_guard lock(mutex_);
  entries_.erase(number);
}

void DialInRegistry::claim(const std::string& number, Deliver deliver) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[number];
  entry.deliver = std::move(deliver);
  if (entry.waiting.valid()) entry.deliver(std::move(entry.waiting));
}

void DialInRegistry::release(const std::string& number) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(number);
  if (found != entries_.end()) found->second.deliver = {};
}

std::optional<FileDescriptor> DialInRegistry::offer(const std::string& number, FileDescriptor socket) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(number);
  if (found == entries_.end()) return socket;
  if (found->second.deliver) {
    found->second.deliver(std::move(socket));
  } else {
    found->second.waiting = std::move(socket);
  }
  return std::nullopt;
}

}  // namespace fieldcast

#include "tools/forward/send/send_window.hpp"

namespace fieldcast::forward {

void SendWindow::add(std::uint64_t id, const std::string& subject) {
  const auto at = waiting_.try_emplace(subject).first;
  if (at->second.empty()) ready_.insert(id);
  at->second.push_back(id);
  subjects_by_id_.emplace(id, at);
}

std::optional<std::uint64_t> SendWindow::next() {
  if (ready_.empty() || in_flight_.size() >= most_in_flight_) return std::nullopt;
  const std::uint64_t id = *ready_.begin();
  ready_.erase(ready_.begin());
  in_flight_.insert(id);
  return id;
}

bool SendWindow::finish(std::uint64_t id) {
  if (in_flight_.erase(id) == 0) return false;
  const auto entry = subjects_by_id_.find(id);
  const auto subject = entry->second;
  subjects_by_id_.erase(entry);
  subject->second.pop_front();
  if (subject->second.empty()) {
    waiting_.erase(subject);
  } else {
    ready_.insert(subject->second.front());
  }
  return true;
}

void SendWindow::fail(std::uint64_t id) {
  if (in_flight_.erase(id) != 0) ready_.insert(id);
}

}  // namespace fieldcast::forward

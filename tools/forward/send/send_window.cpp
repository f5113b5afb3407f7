#include "tools/forward/send/send_window.hpp"

#include <utility>

namespace fieldcast::forward {

void SendWindow::add(std::uint64_t id, Lane lane) {
  const auto at = waiting_.try_emplace(std::move(lane)).first;
  at->second.push_back(id);
  if (at->second.size() == 1) make_ready(*at);
  lanes_by_id_.emplace(id, at);
}

void SendWindow::make_ready(const Lanes::value_type& lane) {
  (lane.first.is_late ? ready_late_ : ready_).insert(lane.second.front());
}

std::optional<std::uint64_t> SendWindow::next(bool late) {
  if (in_flight_.size() >= most_in_flight_) return std::nullopt;
  std::set<std::uint64_t>& from = ready_.empty() && late ? ready_late_ : ready_;
  if (from.empty()) return std::nullopt;
  const std::uint64_t id = *from.begin();
  from.erase(from.begin());
  in_flight_.insert(id);
  return id;
}

bool SendWindow::finish(std::uint64_t id) {
  if (in_flight_.erase(id) == 0) return false;
  const auto entry = lanes_by_id_.find(id);
  const auto lane = entry->second;
  lanes_by_id_.erase(entry);
  lane->second.pop_front();
  if (lane->second.empty()) {
    waiting_.erase(lane);
  } else {
    make_ready(*lane);
  }
  return true;
}

bool SendWindow::fail(std::uint64_t id) {
  if (in_flight_.erase(id) == 0) return false;
  make_ready(*lanes_by_id_.at(id));
  return true;
}

void SendWindow::clear() {
  waiting_.clear();
  lanes_by_id_.clear();
  ready_.clear();
  ready_late_.clear();
  in_flight_.clear();
}

}  // namespace fieldcast::forward

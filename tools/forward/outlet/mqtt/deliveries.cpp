#include "tools/forward/outlet/mqtt/deliveries.hpp"

namespace fieldcast::forward {

void Deliveries::add(std::uint64_t record, int message, Instant now) {
  ++records_[record].open;
  const auto [sent, is_new] = messages_.try_emplace(message, Message{{}, now});
  sent->second.records.push_back(record);
  if (is_new) order_.emplace_back(message, now);
}

void Deliveries::close(std::uint64_t record, std::vector<OutletResult>& results) {
  const auto found = records_.find(record);
  if (found == records_.end() || --found->second.open != 0) return;
  results.push_back(
      {record, found->second.is_refused ? Outcome::kRefused : Outcome::kAcknowledged});
  records_.erase(found);
}

void Deliveries::acknowledge(int message, Outcome outcome, std::vector<OutletResult>& results) {
  const auto found = messages_.find(message);
  if (found == messages_.end()) return;
  const std::vector<std::uint64_t> records = std::move(found->second.records);
  messages_.erase(found);
  for (const std::uint64_t record : records) {
    if (outcome == Outcome::kRefused) refuse(record);
    close(record, results);
  }
}

void Deliveries::fail_all(std::vector<OutletResult>& results) {
  for (const auto& [record, progress] : records_) results.push_back({record, Outcome::kFailed});
  records_.clear();
  messages_.clear();
  order_.clear();
}

std::optional<Instant> Deliveries::oldest() {
  while (!order_.empty()) {
    const auto& [message, sent] = order_.front();
    const auto found = messages_.find(message);
    if (found != messages_.end() && found->second.sent == sent) return sent;
    order_.pop_front();
  }
  return std::nullopt;
}

}  // namespace fieldcast::forward

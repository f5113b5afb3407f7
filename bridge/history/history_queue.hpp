// Requests that wait for the store: one of each requester, and few in total. Pure; one owner.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "bridge/dds/topics/history_values.hpp"

namespace fieldcast {

struct WaitingRequest {
  HistoryRequest request;
  HistoryOutcome refusal = HistoryOutcome::kRows;  // kRows: it must be served
  std::string reason;
};

class HistoryQueue {
 public:
  static constexpr std::size_t kMostServed = 8;
  // Refusals of further requests; beyond that, requests are dropped without a response.
  static constexpr std::size_t kMostRefused = 8;

  // A later request replaces the waiting one of its requester.
  void put(WaitingRequest waiting) {
    const auto same = std::ranges::find_if(waiting_, [&](const WaitingRequest& other) {
      return other.request.requester == waiting.request.requester;
    });
    if (same != waiting_.end()) {
      *same = std::move(waiting);
      return;
    }
    if (waiting_.size() < kMostServed) {
      waiting_.push_back(std::move(waiting));
      return;
    }
    if (refused_.size() >= kMostRefused) return;
    waiting.refusal = HistoryOutcome::kBusy;
    waiting.reason = "other requests wait; repeat it later";
    refused_.push_back(std::move(waiting));
  }
  // Refusals first.
  [[nodiscard]] std::optional<WaitingRequest> take() {
    std::deque<WaitingRequest>& from = refused_.empty() ? waiting_ : refused_;
    if (from.empty()) return std::nullopt;
    WaitingRequest next = std::move(from.front());
    from.pop_front();
    return next;
  }
  [[nodiscard]] bool empty() const { return waiting_.empty() && refused_.empty(); }

 private:
  std::deque<WaitingRequest> waiting_, refused_;
};

}  // namespace fieldcast

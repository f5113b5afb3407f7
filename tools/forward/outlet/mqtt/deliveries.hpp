// Which messages of each record the server has not acknowledged yet. Pure; one owner.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

class Deliveries {
 public:
  // The record has a result when end() was called and all its messages are acknowledged.
  void begin(std::uint64_t record) { ++records_[record].open; }
  // `message` is an id of the connection, unique among the pending ones. A message may belong to
  // several records. REQUIRES: times in their order.
  void add(std::uint64_t record, int message, Instant now);
  // A message of the record was refused: so is the record.
  void refuse(std::uint64_t record) { records_[record].is_refused = true; }
  void end(std::uint64_t record, std::vector<OutletResult>& results) { close(record, results); }

  void acknowledge(int message, Outcome outcome, std::vector<OutletResult>& results);
  // All records without a result have failed.
  void fail_all(std::vector<OutletResult>& results);

  // False for a message without a record.
  [[nodiscard]] bool has(int message) const { return messages_.contains(message); }
  [[nodiscard]] std::size_t messages() const { return messages_.size(); }
  // When the oldest pending message was sent. Empty if there is none.
  [[nodiscard]] std::optional<Instant> oldest();

 private:
  struct Progress {
    std::size_t open = 0;  // messages without an acknowledgement, and 1 until end()
    bool is_refused = false;
  };
  struct Message {
    std::vector<std::uint64_t> records;
    Instant sent{};
  };

  void close(std::uint64_t record, std::vector<OutletResult>& results);

  std::unordered_map<std::uint64_t, Progress> records_;
  std::unordered_map<int, Message> messages_;
  std::deque<std::pair<int, Instant>> order_;  // of messages_, also of acknowledged ones
};

}  // namespace fieldcast::forward

// Which records are sent next, and which wait for their acknowledgement. Pure; one owner.
//
// At most one record of a subject is in flight, so that a later record never overtakes a repeated
// one: the order of each subject, and of each channel in it, is that of the queue. Records of
// different subjects are in flight together.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fieldcast::forward {

class SendWindow {
 public:
  explicit SendWindow(std::size_t most_in_flight) : most_in_flight_(most_in_flight) {}

  // REQUIRES: ids ascend.
  void add(std::uint64_t id, const std::string& subject);
  // The first record that may be sent now; it is in flight then. Empty if there is none.
  [[nodiscard]] std::optional<std::uint64_t> next();
  // Removes a record that was acknowledged or refused. Returns false if it was not in flight.
  bool finish(std::uint64_t id);
  // The record is sent again, before later ones of its subject.
  void fail(std::uint64_t id);

  [[nodiscard]] std::size_t in_flight() const { return in_flight_.size(); }
  [[nodiscard]] std::size_t size() const { return subjects_by_id_.size(); }

 private:
  using Subjects = std::map<std::string, std::deque<std::uint64_t>>;

  const std::size_t most_in_flight_;
  Subjects waiting_;  // in flight or not, by subject; only the first one can be in flight
  std::map<std::uint64_t, Subjects::iterator> subjects_by_id_;
  std::set<std::uint64_t> ready_;  // first records of subjects without a record in flight
  std::set<std::uint64_t> in_flight_;
};

}  // namespace fieldcast::forward

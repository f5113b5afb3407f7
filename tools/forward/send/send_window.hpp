// Which records are sent next, and which wait for their acknowledgement. Pure; one owner.
//
// At most one record of a lane is in flight, so that a later record never overtakes a repeated one:
// the order of each lane is that of the queue. Records of different lanes are in flight together.
// Late samples are sent only while no other record can be sent.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>

#include "tools/forward/batch/record.hpp"

namespace fieldcast::forward {

class SendWindow {
 public:
  explicit SendWindow(std::size_t most_in_flight) : most_in_flight_(most_in_flight) {}

  // The record is sent after those of its lane that were added before.
  void add(std::uint64_t id, Lane lane);
  // The record that is sent now; it is in flight then. Empty if there is none. `late`: a record of
  // late samples is possible.
  [[nodiscard]] std::optional<std::uint64_t> next(bool late = true);
  // Removes a record that was acknowledged or refused. Returns false if it was not in flight.
  bool finish(std::uint64_t id);
  // The record is sent again, before later ones of its lane. Returns false if it was not in flight.
  bool fail(std::uint64_t id);
  // Removes all records.
  void clear();

  [[nodiscard]] std::size_t in_flight() const { return in_flight_.size(); }
  [[nodiscard]] std::size_t size() const { return lanes_by_id_.size(); }

 private:
  using Lanes = std::map<Lane, std::deque<std::uint64_t>>;

  void make_ready(const Lanes::value_type& lane);

  const std::size_t most_in_flight_;
  Lanes waiting_;  // in flight or not, by lane; only the first one can be in flight
  std::map<std::uint64_t, Lanes::iterator> lanes_by_id_;
  // First records of lanes without a record in flight.
  std::set<std::uint64_t> ready_, ready_late_;
  std::set<std::uint64_t> in_flight_;
};

}  // namespace fieldcast::forward

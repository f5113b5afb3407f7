// Distributes the outcome of an exchange to the device, the waiting reads or commands, and the
// pending responses. A failed exchange is repeated if that is safe, and its cause is counted. Owned
// by the bus engine, on the bus's thread; borrows the parts.
#pragma once

#include <optional>
#include <vector>

#include "core/bus/arbiter.hpp"
#include "core/bus/bus_parts.hpp"
#include "core/bus/setup/action_sink.hpp"

namespace fieldcast {

class OutcomeRouter {
 public:
  OutcomeRouter(BusParts& parts, Arbiter& arbiter);

  // Returns Reopen if the port must be opened again.
  [[nodiscard]] std::optional<Reopen> conclude(bool done, Instant now, ActionSink& sink);
  void take_late(const std::vector<LateResponseFilter::Late>& answers, Instant now,
                 ActionSink& sink);

  void count(Cause cause) { causes_.add(cause); }
  [[nodiscard]] const CauseCounters& causes() const { return causes_; }

 private:
  void note_try(const Wire::Ended& ended, Instant now, ActionSink& sink);
  [[nodiscard]] bool may_repeat(Cause cause) const;
  void learn(const Flight& flight);
  void deliver(const Flight& flight, const Wire::Ended& ended, Instant now, ActionSink& sink);
  // Returns true if the device went offline.
  bool device_failed(DeviceIndex device, const Wire::Ended& ended, Instant now, ActionSink& sink);

  const BusSetup& setup_;
  ChannelTable& channels_;
  CommandQueue& commands_;
  ReadPath& reads_;
  DeviceMonitor& devices_;
  LateResponseFilter& late_;
  Wire& wire_;
  Arbiter& arbiter_;
  CauseCounters causes_;
};

}  // namespace fieldcast

// What the end of an exchange means: the outcome goes to the device that was asked, to the reads or
// commands that wait for it, and to the answers that are still owed.
//
// Owns the counters of failed tries. Owned by the bus engine, on the bus's thread; borrows the
// parts. What can fail is the exchange: it is repeated where that is safe, and its cause is
// counted.
#pragma once

#include <optional>
#include <vector>

#include "core/bus/action_sink.hpp"
#include "core/bus/arbiter.hpp"
#include "core/bus/bus_parts.hpp"

namespace fieldcast {

class OutcomeRouter {
 public:
  OutcomeRouter(BusParts& parts, Arbiter& arbiter);

  // The exchange on the wire is done, or failed. Returns why the port must be opened anew, if it
  // must.
  [[nodiscard]] std::optional<Reopen> conclude(bool done, Instant now, ActionSink& sink);
  // Answers came after their exchanges had been given up.
  void take_late(const std::vector<LateAnswers::Late>& answers, Instant now, ActionSink& sink);

  void count(Cause cause) { causes_.add(cause); }
  [[nodiscard]] const CauseCounters& causes() const { return causes_; }

 private:
  void note_try(const Wire::Ended& ended, Instant now, ActionSink& sink);
  [[nodiscard]] bool may_repeat(Cause cause) const;
  void learn(const Flight& flight);
  void deliver(const Flight& flight, const Wire::Ended& ended, Instant now, ActionSink& sink);
  // True: the device went offline.
  bool device_failed(DeviceIndex device, const Wire::Ended& ended, Instant now, ActionSink& sink);

  const BusSetup& setup_;
  ChannelTable& channels_;
  CommandQueue& commands_;
  ReadPath& reads_;
  DeviceMonitor& devices_;
  LateAnswers& late_;
  Wire& wire_;
  Arbiter& arbiter_;
  CauseCounters causes_;
};

}  // namespace fieldcast

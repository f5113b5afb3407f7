// What one bus publishes on DDS, and on which thread. Notes its reports for the metrics on the way.
//
// The block of an exchange leaves at once, on the bus's thread, within the silence after the
// answer: that is the shortest way to the stations. So do a few samples that leave one by one.
// Everything else goes to the publisher thread, so that a bus never waits for DDS. Order is kept:
// nothing overtakes what that thread still has, so DdsLink always has one caller at a time for a
// bus. Called on the bus's thread.
#pragma once

#include <atomic>
#include <vector>

#include "bridge/dds/dds_link.hpp"
#include "bridge/metrics/metrics_table.hpp"
#include "bridge/publish/publisher_thread.hpp"

namespace fieldcast {

class DdsPublisher {
 public:
  // What DDS takes for one sample, on a small machine.
  static constexpr Duration kOneSample = std::chrono::microseconds{50};

  // What it refers to outlives it.
  DdsPublisher(PublisherThread& thread, DdsLink& link, MetricsTable& figures, const BusSpec& bus);

  // True: all left. False: the block left, and publish_later() is to take the samples.
  [[nodiscard]] bool publish_now(const std::vector<Sample>& samples, const UtcMapping& mapping);
  void publish_later(std::vector<Sample> samples, const UtcMapping& mapping);

  void promise(ChannelIndex channel, std::optional<Duration> gap);
  void complete(const CommandResult& result, const UtcMapping& mapping);
  void report(const BusReport& report, UtcTime at);
  void report(std::string_view device, const DeviceReport& report, UtcTime at);
  void report(PlanReport plan, UtcTime at);
  void report(const std::vector<AlarmChange>& changes, const UtcMapping& mapping);

 private:
  template <class Task>
  void post(Task task, PublisherThread::Late late = PublisherThread::Late::kRun);

  PublisherThread& thread_;
  DdsLink& link_;
  MetricsTable& figures_;
  const std::string bus_;
  const std::size_t most_now_;           // samples that the silence has time for
  std::atomic<std::size_t> waiting_{0};  // this bus's tasks that have not ended
};

}  // namespace fieldcast

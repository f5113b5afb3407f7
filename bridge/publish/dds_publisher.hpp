// Publishes the data of one bus on DDS on the right thread, and notes its reports for the metrics.
//
// The block of an exchange, and a few single samples, are written immediately on the bus's thread,
// during the silence after the response: this is fastest. Everything else goes to the publisher
// thread, so that a bus never waits for DDS. The order is kept: while that thread has tasks of the
// bus, nothing is written directly, so DdsLink has one caller at a time per bus. Called on the
// bus's thread.
#pragma once

#include <atomic>
#include <vector>

#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/metrics/metrics_table.hpp"
#include "bridge/publish/publisher_thread.hpp"

namespace fieldcast {

class DdsPublisher {
 public:
  // Time that DDS needs for one sample on a small machine.
  static constexpr Duration kOneSample = std::chrono::microseconds{50};

  // The references must outlive this object.
  DdsPublisher(PublisherThread& thread, DdsLink& link, MetricsTable& figures, const BusSpec& bus);

  // Returns false if only the block was written; then pass the samples to publish_later().
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
  const std::size_t most_now_;           // number of samples that fit in the silence
  std::atomic<std::size_t> waiting_{0};  // unfinished tasks of this bus
};

}  // namespace fieldcast

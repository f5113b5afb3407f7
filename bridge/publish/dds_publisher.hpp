// Where what one bus has to say leaves for: DDS, the store, and the alarms that its samples raise.
//
// A few samples leave at once, within the silence after their answer: that is the shortest way to
// the stations. Everything else goes to the publisher thread, so that a bus never waits for DDS.
// Order is kept: nothing overtakes what the thread still has.
#pragma once

#include <atomic>
#include <map>

#include "bridge/bus/bus_sink.hpp"
#include "bridge/command/command_audit.hpp"
#include "bridge/dds/dds_link.hpp"
#include "bridge/publish/alarm_table.hpp"
#include "bridge/publish/publisher_thread.hpp"
#include "bridge/store/store.hpp"
#include "core/alarm/alarm_monitor.hpp"

namespace fieldcast {

class DdsPublisher final : public BusSink {
 public:
  static constexpr Duration kOneSample =
      std::chrono::microseconds{50};  // what DDS takes for it, on a small machine

  // All of them outlive it; without a store nothing is stored.
  DdsPublisher(PublisherThread& thread, DdsLink& link, Store* store, CommandAudit& audit,
               AlarmTable& alarms, const BusSpec& bus);

  void publish(std::vector<Sample> samples, const UtcMapping& mapping) override;
  void promise(ChannelIndex channel, std::optional<Duration> gap) override;
  void complete(const CommandResult& result, const UtcMapping& mapping) override;
  void report(const BusReport& report, UtcTime at) override;
  void report(std::string_view device, const DeviceReport& report, UtcTime at) override;

 private:
  struct Device {
    std::string protocol, address;
    std::optional<DeviceState> state;  // as stored last
  };
  void keep(const std::vector<Sample>& samples, const UtcMapping& mapping, Instant now);
  enum class News : std::uint8_t { kNew, kRestored };
  void tell(const std::vector<AlarmChange>& changes, const UtcMapping& mapping,
            News news = News::kNew);
  void restore_alarms();
  template <class Task>
  void post(Task task, PublisherThread::Late late = PublisherThread::Late::kRun);

  PublisherThread& thread_;
  DdsLink& link_;
  Store* const store_;
  CommandAudit& audit_;
  const BusSpec spec_;
  const std::unique_ptr<Store::Intake> intake_;  // null: nothing is stored
  AlarmTable& active_;
  AlarmMonitor alarms_;
  std::uint64_t restored_ = 0;                              // version of active_
  std::vector<std::pair<std::string, std::string>> names_;  // device and channel, by channel index
  std::map<std::string, Device, std::less<>> devices_;
  std::size_t at_once_;                  // samples that the silence has time for
  std::atomic<std::size_t> waiting_{0};  // this bus's tasks that have not ended
};

}  // namespace fieldcast

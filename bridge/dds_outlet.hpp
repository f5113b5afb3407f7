// Where what one bus has to say leaves for: DDS, the store, and the alarms that its samples raise.
//
// A few samples leave at once, within the silence after their answer: that is the shortest way to the stations. Everything else
// goes to the outlet thread, so that a bus never waits for DDS. Order is kept: nothing overtakes what the thread still has.
#pragma once

#include <atomic>
#include <map>

#include "bridge/bus_outlet.hpp"
#include "bridge/command_audit.hpp"
#include "bridge/dds/dds_link.hpp"
#include "bridge/outlet_thread.hpp"
#include "bridge/store/store.hpp"
#include "core/alarm/alarm_book.hpp"

namespace fieldcast {

class DdsOutlet final : public BusOutlet {
 public:
  static constexpr Duration kOneSample = std::chrono::microseconds{50};  // what DDS takes for it, on a small machine

  // All of them outlive it; without a store nothing is stored.
  DdsOutlet(OutletThread& thread, DdsLink& link, Store* store, CommandAudit& audit, const BusSpec& bus);

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
  void tell(const std::vector<AlarmChange>& changes, const UtcMapping& mapping);
  template <class Task>
  void post(Task task);

  OutletThread& thread_;
  DdsLink& link_;
  Store* const store_;
  CommandAudit& audit_;
  const BusSpec spec_;
  const std::unique_ptr<Store::Intake> intake_;  // null: nothing is stored
  AlarmBook alarms_;
  std::vector<std::pair<std::string, std::string>> names_;  // device and channel, by channel index
  std::map<std::string, Device, std::less<>> devices_;
  std::size_t at_once_;                  // samples that the silence has time for
  std::atomic<std::size_t> waiting_{0};  // this bus's tasks that have not ended
};

}  // namespace fieldcast

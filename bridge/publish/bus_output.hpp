// Output of one bus: DDS, store, alarms, metrics, audit of commands. On the bus's thread.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/alarm/alarm_table.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/calculate/input_relay.hpp"
#include "bridge/command/command_service.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/metrics/metrics_snapshot.hpp"
#include "bridge/publish/publisher_thread.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/store/command_audit.hpp"
#include "bridge/store/store.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

// Stores samples and device states of one bus. On the bus's thread; never waits for the store.
class StoreRecorder {
 public:
  // The store outlives this object.
  StoreRecorder(Store& store, const BusSpec& bus);

  // `now`: time of publication.
  void put(std::span<const Sample> samples, const UtcMapping& mapping, Instant now);
  void put(std::string_view device, DeviceState state, UtcTime at);

 private:
  struct Device {
    std::string protocol, address;
    std::optional<DeviceState> state;  // last stored state
  };
  Store& store_;
  const std::string bus_;
  const std::unique_ptr<Store::Intake> intake_;
  std::map<std::string, Device, std::less<>> devices_;
};

// The block of an exchange, and a few single samples, are written on the bus's thread, during the
// silence after the response: fastest. Everything else goes to the publisher thread, so that a bus
// never waits for DDS. The order is kept: while that thread has tasks of the bus, all tasks go
// there.
class BusOutput final : public BusSink {
 public:
  // Time that DDS needs for one sample on a small machine.
  static constexpr Duration kOneSample = std::chrono::microseconds{50};

  // Objects that all buses share; they outlive the outputs. `store` is null without a store.
  struct Shared {
    PublisherThread& thread;
    DdsLink& link;
    Store* store;
    CommandAudit& audit;
    CommandService& commands;
    AlarmTable& alarms;
    InputRelay& inputs;
    MetricsTable& figures;
    MasterLease& lease;
    bool in_group = false;
  };
  BusOutput(const Shared& shared, const BusSpec& bus);

  // After a takeover from a vanished master, holds bad values until the first good one or `limit`.
  // Another bridge may still use the wire and publish good values. Any thread.
  void prove_until(Instant limit, Instant now) { hold_.prove_until(limit, now); }

  void publish(std::vector<Sample> samples, const UtcMapping& mapping) override;
  void promise(ChannelIndex channel, std::optional<Duration> gap) override;
  void complete(const CommandResult& result, const UtcMapping& mapping) override;
  void report(const BusReport& report, UtcTime at) override;
  void report(std::string_view device, const DeviceReport& report, UtcTime at) override;
  void report(PlanReport plan, UtcTime at) override;

 private:
  // Runs `task` on the publisher thread.
  template <class Task>
  void post(Task task, PublisherThread::Late late = PublisherThread::Late::kRun);
  void report(const std::vector<AlarmChange>& changes, const UtcMapping& mapping);

  PublisherThread& thread_;
  DdsLink& link_;
  InputRelay& inputs_;
  MetricsTable& figures_;
  SampleHold hold_;
  CommandAudit& audit_;
  CommandService& commands_;
  MasterLease& lease_;
  const bool in_group_;
  std::uint64_t foreign_masters_ = 0;
  const std::string bus_;
  const std::size_t most_now_;           // number of samples that fit in the silence
  std::atomic<std::size_t> waiting_{0};  // unfinished tasks of this bus
  std::optional<StoreRecorder> store_;
  AlarmReporter alarms_;
};

}  // namespace fieldcast

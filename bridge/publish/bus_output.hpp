// Output of one bus: DDS, the store, the alarms, the audit of commands. Owns the objects that
// belong only to this bus. Called on the bus's thread.
#pragma once

#include <functional>
#include <optional>

#include "bridge/bus/bus_sink.hpp"
#include "bridge/publish/alarm_reporter.hpp"
#include "bridge/publish/dds_publisher.hpp"
#include "bridge/publish/sample_hold.hpp"
#include "bridge/publish/store_recorder.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/store/command_audit.hpp"

namespace fieldcast {

class BusOutput final : public BusSink {
 public:
  // Objects that all buses share; they outlive the outputs. `store` is null without a store.
  struct Shared {
    PublisherThread& thread;
    DdsLink& link;
    Store* store;
    CommandAudit& audit;
    AlarmTable& alarms;
    MetricsTable& figures;
    MasterLease& lease;
    // Returns true if it has taken the result, which is then not published.
    std::function<bool(const std::string& bus, const CommandResult& result)> keeps_result{};
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
  SampleHold hold_;
  CommandAudit& audit_;
  MasterLease& lease_;
  const std::function<bool(const std::string&, const CommandResult&)> keeps_result_;
  const bool in_group_;
  std::uint64_t foreign_masters_ = 0;
  const std::string bus_;
  DdsPublisher dds_;
  std::optional<StoreRecorder> store_;
  AlarmReporter alarms_;
};

}  // namespace fieldcast

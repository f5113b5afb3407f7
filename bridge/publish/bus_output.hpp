// Where everything that one bus produces goes: DDS, the store, the alarms, the audit of commands.
// Owns what belongs to the bus alone. Called on the bus's thread.
#pragma once

#include <functional>
#include <optional>

#include "bridge/bus/bus_sink.hpp"
#include "bridge/command/command_audit.hpp"
#include "bridge/publish/alarm_reporter.hpp"
#include "bridge/publish/dds_publisher.hpp"
#include "bridge/publish/sample_hold.hpp"
#include "bridge/publish/store_recorder.hpp"
#include "bridge/standby/master_lease.hpp"

namespace fieldcast {

class BusOutput final : public BusSink {
 public:
  // What all buses share. It outlives the outputs; without a store nothing is stored.
  struct Shared {
    PublisherThread& thread;
    DdsLink& link;
    Store* store;
    CommandAudit& audit;
    AlarmTable& alarms;
    MetricsTable& figures;
    MasterLease& lease;
    // Takes a result instead of DDS: true, and it is not published.
    std::function<bool(const std::string& bus, const CommandResult& result)> keeps_result{};
    // Whether it belongs to a standby group.
    bool in_group = false;
  };
  BusOutput(const Shared& shared, const BusSpec& bus);

  // From a master that has just vanished the bus was taken over: until the first good value comes,
  // or until then, bad ones stay here. The wire may be another bridge's after all, whose values
  // they would push aside. Any thread.
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
  std::uint64_t foreign_masters_ = 0;  // as of the last report
  const std::string bus_;
  DdsPublisher dds_;
  std::optional<StoreRecorder> store_;
  AlarmReporter alarms_;
};

}  // namespace fieldcast

// Where everything that one bus produces goes: DDS, the store, the alarms, the audit of commands.
// Owns what belongs to the bus alone. Called on the bus's thread.
#pragma once

#include <optional>

#include "bridge/bus/bus_sink.hpp"
#include "bridge/command/command_audit.hpp"
#include "bridge/publish/alarm_reporter.hpp"
#include "bridge/publish/dds_publisher.hpp"
#include "bridge/publish/store_recorder.hpp"

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
  };
  BusOutput(const Shared& shared, const BusSpec& bus);

  void publish(std::vector<Sample> samples, const UtcMapping& mapping) override;
  void promise(ChannelIndex channel, std::optional<Duration> gap) override;
  void complete(const CommandResult& result, const UtcMapping& mapping) override;
  void report(const BusReport& report, UtcTime at) override;
  void report(std::string_view device, const DeviceReport& report, UtcTime at) override;
  void report(PlanReport plan, UtcTime at) override;

 private:
  CommandAudit& audit_;
  const std::string bus_;
  DdsPublisher dds_;
  std::optional<StoreRecorder> store_;
  AlarmReporter alarms_;
};

}  // namespace fieldcast

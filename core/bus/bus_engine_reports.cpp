#include "core/bus/bus_engine.hpp"

namespace fieldcast {

std::string BusEngine::request_text(ByteView sent) const {
  const auto sender = parts_.sender_of(sent);
  return sender ? flight_text(parts_, parts_.wires[*sender].flight()) : std::string();
}

std::optional<DeviceIndex> BusEngine::asked_device(ByteView sent) const {
  const auto sender = parts_.sender_of(sent);
  if (!sender) return std::nullopt;
  return parts_.wires[*sender].flight().asked.device;
}

BusReport BusEngine::bus_report(Instant now) {
  WireLoad::Shares shares;
  BusReport report;
  for (Wire& wire : parts_.wires) {
    const WireLoad::Shares own = wire.shares(now);
    shares.busy += own.busy / static_cast<double>(parts_.wires.size());
    shares.reading += own.reading / static_cast<double>(parts_.wires.size());
    report.exchanges += wire.exchanges();
    report.bytes_sent += wire.driver().bytes_sent();
    report.bytes_received += wire.driver().bytes_received();
  }
  report.state = state_;
  if (state_ == BusState::kClosed) report.closed_because = closed_because_;
  report.utilisation = shares.busy;
  report.measured_load = shares.reading;
  report.planned_load = parts_.reads.planned_load();
  report.stretch = parts_.reads.stretch();
  report.silence = parts_.wires.front().silence();
  report.listening = state_ == BusState::kRunning && parts_.fence.listening();
  report.foreign_masters = parts_.fence.foreign_masters();
  report.samples = samples_;
  report.commands = parts_.commands.done();
  report.reopened = reopened_;
  report.causes = outcomes_.causes();
  report.misses = parts_.channels.misses(now);
  report.deadline_misses = report.misses.total();
  return report;
}

DeviceReport BusEngine::device_report(DeviceIndex device, Instant now) const {
  DeviceReport report = parts_.devices.report(device);
  if (state_ == BusState::kClosed) report.state = DeviceState::kUnknown;
  parts_.reads.describe(device, report);
  for (ChannelIndex c = parts_.channels.first_of(device); c < parts_.channels.end_of(device); ++c)
    report.deadline_misses += parts_.channels.report(c, now).missed;
  return report;
}

}  // namespace fieldcast
